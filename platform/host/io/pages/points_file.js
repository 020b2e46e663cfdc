// The lines of points.csv: a cell with commas or quotes is in quotes, and quotes in it are doubled.
"use strict";
const csvCell = text => /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
const csvCells = line => [...("," + line).matchAll(/,\s*(?:"((?:[^"]|"")*)"\s*(?=,|$)|([^,]*))/g)]
  .map(([, quoted, plain]) => quoted === undefined ? plain.trim() : quoted.replace(/""/g, '"'));
/// The rows of a file, the header first, each a list of cells.
const csvRows = text => text.replace(/^\ufeff/, "").split(/\r?\n/).filter(line => line.trim()).map(csvCells);

if (typeof module !== "undefined") module.exports = { csvCell, csvRows };
