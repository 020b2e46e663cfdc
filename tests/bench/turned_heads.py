#!/usr/bin/env python3
"""Heads that turn to 60 degrees on both sides and back, rendered with random identities, and tracked: errors of rotation and
landmarks, and the states, by yaw.

usage: turned_heads.py PLIANT FACE.plm PEOPLE [--first N] [--size WxH] [--folder FOLDER] [TRACK OPTIONS...]
The people are those numbered from --first (0). Two starts: by detection, and from the 68 landmarks of frame 0.
Films stay in the folder (turned_heads) and are not rendered again.
"""
import csv
import math
import os
import random
import subprocess
import sys

FRAMES, NOISE = 240, 2
YAWS = (0, 15, 30, 45, 57)  # lower ends of the rows, degrees


def rotation(yaw, pitch, roll):
    """Quaternion of Rz(roll) Ry(yaw) Rx(pitch), degrees."""
    h = math.pi / 360
    cy, sy, cp, sp, cr, sr = (f(h * a) for a in (yaw, pitch, roll) for f in (math.cos, math.sin))
    return cr * cy * cp + sr * sy * sp, cr * cy * sp - sr * sy * cp, cr * sy * cp + sr * cy * sp, sr * cy * cp - cr * sy * sp


def motion(n, side):
    q = rotation(60 * side * math.sin(2 * math.pi * n / (FRAMES - 1)), 8 * math.sin(2 * math.pi * n / 97),
                 5 * math.sin(2 * math.pi * n / 140))
    t = (20 * math.sin(2 * math.pi * n / 120), -28 + 8 * math.sin(2 * math.pi * n / 80), 560 + 30 * math.sin(2 * math.pi * n / 170))
    smile, brow = 0.4 * max(0, math.sin(2 * math.pi * n / 111 + 1)), 0.5 * max(0, math.sin(2 * math.pi * n / 77))
    blink = 1 if n % 60 in (31, 32, 33) else 0
    return [*q, *t, 0.12 * max(0, math.sin(2 * math.pi * n / 23)), smile, smile, brow, brow, blink, blink]


MOVED = ['qw', 'qx', 'qy', 'qz', 'tx', 'ty', 'tz', 'jawOpen', 'mouthSmileLeft', 'mouthSmileRight', 'browInnerUpLeft',
         'browInnerUpRight', 'eyeBlinkLeft', 'eyeBlinkRight']


def identity_names():
    table = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'fixtures', 'face', 'parameters.txt')
    rows = [line.split() for line in open(table) if line.strip() and not line.startswith('#')]
    return [r[0] for r in rows if r[1] == 'identity']


def render(pliant, face, person, size, folder, rows):
    """Renders a person's film, a frame for each row of values of MOVED, and gives the beginning of its files' names."""
    os.makedirs(folder, exist_ok=True)
    stem = os.path.join(folder, '%d_%s' % (person, size))
    if os.path.exists(stem + '.points.csv'):
        return stem
    draw = random.Random(person)
    names = identity_names()
    who = [max(-2, min(2, draw.gauss(0, 1))) for _ in names]
    with open(stem + '.q.csv', 'w') as out:
        print(','.join(['frame'] + MOVED + names), file=out)
        for n, row in enumerate(rows):
            print(','.join('%.6g' % v for v in [n] + row + who), file=out)
    subprocess.run([pliant, 'render', face, '--params', stem + '.q.csv', '--size', size, '--noise', str(NOISE), '--seed',
                    str(person + 1), '-o', stem + '.y4m', '--truth', stem + '.truth.csv', '--truth-points', stem + '.all.csv'],
                   check=True, stdout=subprocess.DEVNULL)
    with open(stem + '.points.csv', 'w') as out:
        print('landmark,x,y', file=out)
        out.writelines(line[2:] for line in open(stem + '.all.csv') if line.startswith('0,ibug'))
    return stem


def quaternion(row):
    return [float(row[c]) for c in ('qw', 'qx', 'qy', 'qz')]


def angle(a, b):
    return math.degrees(2 * math.acos(min(1, abs(sum(x * y for x, y in zip(a, b))))))


def yaw(q):
    return math.degrees(math.asin(max(-1, min(1, 2 * (q[0] * q[2] - q[3] * q[1])))))


def point(row, name):
    return float(row['x_' + name]), float(row['y_' + name])


def eye_distance(row):
    return math.dist(point(row, 'ibug36'), point(row, 'ibug45'))


def landmark_error(truth, row, eyes):
    """Mean over ibug17 to ibug67, % of the distance of the eyes."""
    names = ['ibug%02d' % k for k in range(17, 68)]
    return 100 * sum(math.dist(point(truth, n), point(row, n)) for n in names) / len(names) / eyes


def at(values, fraction):
    values = sorted(values)
    return values[min(len(values) - 1, int(fraction * len(values)))] if values else float('nan')


def arguments(argv, options, usage):
    """The words that are no options, at least three, and the values of the options, which are changed in place."""
    rest = []
    while argv:
        word = argv.pop(0)
        if word in options:
            options[word] = argv.pop(0)
        else:
            rest.append(word)
    if len(rest) < 3:
        sys.exit(usage)
    return rest


def main(argv):
    options = {'--first': '0', '--size': '320x240', '--folder': 'turned_heads'}
    pliant, face, count, *more = arguments(argv, options, __doc__)
    size, folder, first, count = options['--size'], options['--folder'], int(options['--first']), int(count)
    focal = str(1.4 * int(size.split('x')[0]))
    print('| start | yaw, degrees | rotation, median deg | at 95 % | landmarks, % | tracking | degraded | lost |')
    print('|---|---|---:|---:|---:|---:|---:|---:|')
    for start in ('detection', '68 landmarks'):
        turns, marks, states = {b: [] for b in YAWS}, {b: [] for b in YAWS}, {b: [0, 0, 0] for b in YAWS}
        for person in range(first, first + count):
            side = 1 - 2 * (person % 2)
            stem = render(pliant, face, person, size, folder, [motion(n, side) for n in range(FRAMES)])
            init = [] if start == 'detection' else ['--init', stem + '.points.csv']
            subprocess.run([pliant, 'track', face, '--frames', stem + '.y4m', '--landmarks', '--focal', focal, '--out',
                            stem + '.track.csv'] + init + more, check=True, stdout=subprocess.DEVNULL)
            truth = list(csv.DictReader(open(stem + '.truth.csv')))
            eyes = eye_distance(truth[0])
            for t, r in zip(truth, csv.DictReader(open(stem + '.track.csv'))):
                b = max(x for x in YAWS if x <= abs(yaw(quaternion(t))))
                states[b][('tracking', 'degraded', 'lost').index(r['state'])] += 1
                if r['state'] == 'lost':
                    continue
                turns[b].append(angle(quaternion(t), quaternion(r)))
                marks[b].append(landmark_error(t, r, eyes))
        for b in YAWS + ('all',):
            keys = YAWS if b == 'all' else (b,)
            e, m = [x for k in keys for x in turns[k]], [x for k in keys for x in marks[k]]
            s = [sum(states[k][j] for k in keys) for j in range(3)]
            label = 'all' if b == 'all' else 'from %d' % b
            print('| %s | %s | %.2f | %.2f | %.2f | %d | %d | %d |' %
                  (start, label, at(e, 0.5), at(e, 0.95), sum(m) / max(1, len(m)), *s))


if __name__ == '__main__':
    main(sys.argv[1:])
