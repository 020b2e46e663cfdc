#!/usr/bin/env python3
"""Plays the films of portraits with faults (portrait_films.py --keep FOLDER) one after another, in random order, as one film with a
cut wherever the next one begins, and tracks it. Says how many frames are right and wrong as portrait_films.py does, beside those of
the same films tracked each alone, and which films lose most: what a fault leaves behind in the tracker would show there.

usage: chained_films.py PLIANT FACE.plm PORTRAITS FOLDER [--seed N] [TRACK OPTIONS...]
  FOLDER    films, with the tracks of each alone; the track of all goes to FOLDER/chained.csv
  --seed N  of the order (1)
"""
import csv
import itertools
import os
import random
import subprocess
import sys

import numpy

import portrait_film
import turned_heads as heads
from portrait_films import score

WORST = 8  # films that are listed


def play(command, films):
    """Tracks the films as one, whose header is the first film's."""
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as process:
        for k, film in enumerate(films):
            with open(film, 'rb') as file:
                header = file.readline()
                process.stdin.write((header if k == 0 else b'') + file.read())
        process.stdin.close()
    if process.returncode != 0:
        sys.exit('chained_films.py: the track failed')


def main(argv):
    options = {'--seed': '1'}
    pliant, face, portraits, folder, *more = heads.arguments(argv, options, __doc__)
    landmarks = portrait_film.read_landmarks(portraits)
    films = sorted(name for name in os.listdir(folder) if os.path.exists(os.path.join(folder, name, 'film.y4m')))
    random.Random(int(options['--seed'])).shuffle(films)
    chained = os.path.join(folder, 'chained.csv')
    play([pliant, 'track', face, '--frames', '-', '--landmarks', '--out', chained] + more,
         [os.path.join(folder, name, 'film.y4m') for name in films])
    results = []
    with open(chained) as together:
        rows = csv.DictReader(together)
        for name in films:
            person = max((p for p in landmarks if name.startswith(p)), key=len)
            truth = numpy.load(os.path.join(folder, name, 'truth.npy'))
            here = score(itertools.islice(rows, len(truth)), truth, sorted(landmarks[person]))
            with open(os.path.join(folder, name, 'track.csv')) as alone:
                results.append((name, here[:3], score(csv.DictReader(alone), truth, sorted(landmarks[person]))[:3]))
    print('| films | shown | right, %, one after another | wrong | right, %, each alone | wrong |')
    print('|---|---:|---:|---:|---:|---:|')
    results.sort(key=lambda r: r[1][1] - r[2][1])
    for name, of in [('all', results)] + [(r[0], [r]) for r in results[:WORST]]:
        shown, right, wrong, _, right_alone, wrong_alone = (sum(r[1 + k // 3][k % 3] for r in of) for k in range(6))
        print('| %s | %d | %.2f | %d | %.2f | %d |' % (name, shown, 100 * right / shown, wrong, 100 * right_alone / shown, wrong_alone))


if __name__ == '__main__':
    main(sys.argv[1:])
