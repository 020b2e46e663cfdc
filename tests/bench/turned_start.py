#!/usr/bin/env python3
"""Heads that are turned where their film begins, and turn back until frame 120 of 180; rendered with random identities (turned_heads.py),
and tracked without a start: errors of rotation and landmarks, of the whole film and late, when the head is frontal again.

usage: turned_start.py PLIANT FACE.plm PEOPLE [--first N] [--yaw DEGREES] [--folder FOLDER] [TRACK OPTIONS...]
The people are those numbered from --first (0), turned by --yaw (60). Films stay in the folder (turned_start) and are not rendered
again.
"""
import csv
import math
import subprocess
import sys

import turned_heads as heads

FRAMES, FRONTAL, LATE = 180, 120, 150
STATES = ('tracking', 'degraded', 'lost')


def motion(n, yaw):
    row = heads.motion(n, 1)
    turn = yaw * (0.5 + 0.5 * math.cos(math.pi * min(n, FRONTAL) / FRONTAL))
    row[:4] = heads.rotation(turn, 8 * math.sin(2 * math.pi * n / 97), 5 * math.sin(2 * math.pi * n / 140))
    return row


def main(argv):
    options = {'--first': '0', '--yaw': '60', '--folder': 'turned_start'}
    pliant, face, count, *more = heads.arguments(argv, options, __doc__)
    first, yaw = int(options['--first']), float(options['--yaw'])
    turns, late, marks, states = [], [], [], [0, 0, 0]
    for person in range(first, first + int(count)):
        side = 1 - 2 * (person % 2)
        stem = heads.render(pliant, face, person, '320x240', options['--folder'] + '_%g' % yaw,
                            [motion(n, yaw * side) for n in range(FRAMES)])
        subprocess.run([pliant, 'track', face, '--frames', stem + '.y4m', '--landmarks', '--focal', '448', '--out', stem + '.track.csv'] +
                       more, check=True, stdout=subprocess.DEVNULL)
        truth = list(csv.DictReader(open(stem + '.truth.csv')))
        eyes = heads.eye_distance(truth[FRONTAL])
        for n, (t, r) in enumerate(zip(truth, csv.DictReader(open(stem + '.track.csv')))):
            states[STATES.index(r['state'])] += 1
            if r['state'] == 'lost':
                continue
            turns.append(heads.angle(heads.quaternion(t), heads.quaternion(r)))
            marks.append(heads.landmark_error(t, r, eyes))
            late += turns[-1:] if n >= LATE else []
    print('| rotation, median deg | at 95 % | late, median | at 95 % | landmarks, % | tracking | degraded | lost |')
    print('|---:|---:|---:|---:|---:|---:|---:|---:|')
    print('| %.2f | %.2f | %.2f | %.2f | %.2f | %d | %d | %d |' %
          (heads.at(turns, 0.5), heads.at(turns, 0.95), heads.at(late, 0.5), heads.at(late, 0.95), sum(marks) / max(1, len(marks)), *states))


if __name__ == '__main__':
    main(sys.argv[1:])
