// Tests without a browser that the page of `pliant points` reads the points.csv that it writes, and those of others.
// usage: node points_file.js SOURCE_FOLDER
"use strict";
const assert = require("assert");
const path = require("path");
const { csvCell, csvRows } = require(path.join(process.argv[2], "platform/host/io/pages/points_file.js"));

for (const name of ["ibug36", "eye, left", 'the "tip"', '"', ",", '",",', "a b", "ä"])
  assert.deepStrictEqual(csvRows(`landmark,x,y\n${csvCell(name)},1.50,-2.00\n`), [["landmark", "x", "y"], [name, "1.50", "-2.00"]]);
assert.deepStrictEqual(csvRows('\ufefflandmark, x ,y\r\n\r\n "a" ,"1",2\r\n'), [["landmark", "x", "y"], ["a", "1", "2"]]);
assert.deepStrictEqual(csvRows(',,3\nx,"",\n"cut'), [["", "", "3"], ["x", "", ""], ['"cut']]);
assert.deepStrictEqual(csvRows(""), []);
