#!/usr/bin/env python3
"""Sheets whose print repeats, rendered while they move, turn and bend, tracked from the true first points: how many frames are
tracked and right, and how many are tracked and wrong.

usage: repeating_prints.py PLIANT [--prints NAME,...] [--speeds PX,...] [--folder FOLDER] [TRACK OPTIONS...]
  --prints NAME,...  kind-size, kinds of KINDS below, size of the pattern in mm on a sheet of 210 x 297 (CHOSEN and REPORTED)
  --speeds PX,...    largest speed, px a frame of 640 x 480, where a mm is 1.15 px (3,6,12,20)
  --folder FOLDER    models, films and tracks (repeating_prints); what is there is not made again

Right: the median distance of nine points of the sheet from their places, both without bending, is at most 6 px. 120 frames a film.
"""
import argparse
import csv
import math
import os
import statistics
import subprocess

import turned_heads as heads

FRAMES, FOCAL, AWAY_MM, SIZE = 120, 896, 780, (640, 480)
WIDTH_MM, HEIGHT_MM, WIDTH_PX, HEIGHT_PX = 210, 297, 480, 679
MOST_OFF_PX = 6
CHOSEN = 'checks-15,checks-25,checks-50,dots-20,weave-20,bricks-15'
REPORTED = 'checks-35,bricks-8,bricks-25,dots-12,dots-30,weave-30,weave-45'
SHEET = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'fixtures', 'sheet')
POINTS = [(x, y) for x in (-WIDTH_MM / 2, 0, WIDTH_MM / 2) for y in (-HEIGHT_MM / 2, 0, HEIGHT_MM / 2)]


# --- Prints: grey level at (x, y), counted in patterns ---

def checks(x, y):
    return 50 + 160 * ((int(x) + int(y)) % 2)


def dots(x, y):
    return 50 if math.hypot(x % 1 - 0.5, y % 1 - 0.5) < 0.3 else 200


def weave(x, y):
    return 120 + 60 * math.sin(2 * math.pi * x) * math.sin(2 * math.pi * y) + 20 * math.sin(6 * math.pi * x)


def bricks(x, y):
    return 60 if y % 1 < 0.12 or (x / 2 + 0.5 * (int(y) % 2)) % 1 < 0.06 else 150


KINDS = {'checks': checks, 'dots': dots, 'weave': weave, 'bricks': bricks}


def bake(pliant, folder, name):
    model = os.path.join(folder, name + '.plm')
    if os.path.exists(model):
        return model
    kind, size = name.split('-')
    scale = WIDTH_MM / WIDTH_PX / float(size)
    picture = os.path.join(folder, name + '.pgm')
    with open(picture, 'wb') as out:
        out.write(b'P5 %d %d 255\n' % (WIDTH_PX, HEIGHT_PX))
        out.write(bytes(int(KINDS[kind](x * scale, y * scale)) for y in range(HEIGHT_PX) for x in range(WIDTH_PX)))
    run(pliant, 'bake', SHEET, '--modes', '6', '--texture', picture, '-o', model)
    return model


def motion(n, speed):
    """Rotation, translation and two bending modes of frame n; a slow begin."""
    begun = min(1, n / 15)
    q = heads.rotation(12 * math.sin(2 * math.pi * n / 70) * begun + 3, 9 * math.sin(2 * math.pi * n / 90) * begun + 2,
                       8 * math.sin(2 * math.pi * n / 80) * begun)
    reach = speed * AWAY_MM / FOCAL * FRAMES / (4 * math.pi) * begun
    phase = 4 * math.pi * n / FRAMES
    return [*q, reach * math.sin(phase), 0.3 * reach * math.sin(1.3 * phase), AWAY_MM,
            0.8 * math.sin(2 * math.pi * n / 50) * begun, 0.5 * math.sin(2 * math.pi * n / 61) * begun]


def render(pliant, model, speed):
    stem = '%s-%g' % (model[:-4], speed)
    if os.path.exists(stem + '.csv'):
        return stem
    with open(stem + '.q.csv', 'w') as out:
        print('frame,qw,qx,qy,qz,tx,ty,tz,mode00,mode01', file=out)
        for n in range(FRAMES):
            print(','.join('%.6g' % v for v in [n] + motion(n, speed)), file=out)
    run(pliant, 'render', model, '--params', stem + '.q.csv', '--size', '%dx%d' % SIZE, '-o', stem + '.y4m', '--truth', stem + '.csv')
    return stem


def places(row):
    """Of POINTS in the picture, px, without bending. The model's y points up, and its z to the camera."""
    w, x, y, z = heads.quaternion(row)
    t = [float(row[name]) for name in ('tx', 'ty', 'tz')]
    out = []
    for a, b in POINTS:
        p = (a, -b)
        q = [(1 - 2 * (y * y + z * z)) * p[0] + 2 * (x * y - w * z) * p[1] + t[0],
             2 * (x * y + w * z) * p[0] + (1 - 2 * (x * x + z * z)) * p[1] + t[1],
             2 * (x * z - w * y) * p[0] + 2 * (y * z + w * x) * p[1] + t[2]]
        out.append(tuple(FOCAL * q[k] / q[2] + (SIZE[k] - 1) / 2 for k in (0, 1)))
    return out


def track(pliant, model, stem, more):
    """How many frames are tracked and right, and tracked and wrong."""
    truth = list(csv.DictReader(open(stem + '.csv')))
    with open(stem + '.points.csv', 'w') as out:
        print('landmark,u,v,x,y', file=out)
        for k, ((a, b), place) in enumerate(zip(POINTS, places(truth[0]))):
            print('p%d,%g,%g,%g,%g' % (k, a / WIDTH_MM + 0.5, 0.5 - b / HEIGHT_MM, *place), file=out)
    run(pliant, 'track', model, '--frames', stem + '.y4m', '--init', stem + '.points.csv', '--focal', str(FOCAL), '--out',
        stem + '.track.csv', *more)
    off = [statistics.median(math.dist(a, b) for a, b in zip(places(row), places(truth[int(row['frame'])])))
           for row in csv.DictReader(open(stem + '.track.csv')) if row['state'] == 'tracking']
    right = sum(px <= MOST_OFF_PX for px in off)
    return right, len(off) - right


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main():
    reader = argparse.ArgumentParser(usage=__doc__)
    reader.add_argument('pliant')
    for name, default in (('--prints', CHOSEN + ',' + REPORTED), ('--speeds', '3,6,12,20'), ('--folder', 'repeating_prints')):
        reader.add_argument(name, default=default)
    options, more = reader.parse_known_args()
    speeds = [float(s) for s in options.speeds.split(',')]
    os.makedirs(options.folder, exist_ok=True)
    print('| print, mm | %s |' % ' | '.join('%g px a frame: right, wrong' % s for s in speeds))
    print('|---|%s' % ('---:|' * len(speeds)))
    for name in options.prints.split(','):
        model = bake(options.pliant, options.folder, name)
        cells = ['%d, %d' % track(options.pliant, model, render(options.pliant, model, s), more) for s in speeds]
        print('| %s | %s |' % (name.replace('-', ', '), ' | '.join(cells)), flush=True)


if __name__ == '__main__':
    main()
