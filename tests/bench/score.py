#!/usr/bin/env python3
"""Scores a track (CSV of `pliant track --landmarks` or `--markers`) against points that are known in every frame.

usage: score.py TRACK.csv TRUTH.csv [PREFIX]
TRUTH.csv: frame,landmark,x,y; PREFIX keeps the landmarks whose names begin with it. Prints name=value pairs. Python's
standard library is enough.
"""
import csv
import math
import statistics
import sys

OUTER_EYES = (('ibug36', 'ibug45'), ('fgnet27', 'fgnet32'))
MOUTH = (('ibug51', 'ibug57'), ('fgnet51', 'fgnet57'))
FAILURE_NME = 10.0  # percent: a frame beyond counts as failed


def read_truth(path):
    """{frame: {landmark: (x, y)}}"""
    truth = {}
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            truth.setdefault(int(row['frame']), {})[row['landmark']] = (float(row['x']), float(row['y']))
    return truth


def read_track(path):
    """{frame: (state, {landmark: (x, y)})}"""
    track = {}
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            points = {}
            for column, value in row.items():
                if column.startswith('x_') and value:
                    points[column[2:]] = (float(value), float(row['y_' + column[2:]]))
            track[int(row['frame'])] = (row['state'], points)
    return track


def first_pair(frame, pairs):
    for pair in pairs:
        if pair[0] in frame and pair[1] in frame:
            return pair
    return None


def percentile(values, fraction):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(fraction * len(ordered)))]


def correlation(a, b):
    mean_a, mean_b = statistics.fmean(a), statistics.fmean(b)
    product = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    size = math.sqrt(sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b))
    return product / size if size > 0 else 0.0


def trembling(frames, names, position):
    """Root mean square second difference, px."""
    squares = []
    for k in frames:
        if k - 1 not in frames or k + 1 not in frames:
            continue
        for name in names:
            before, here, after = (position(j)[name] for j in (k - 1, k, k + 1))
            squares.append(sum((before[i] - 2 * here[i] + after[i]) ** 2 for i in (0, 1)))
    return math.sqrt(statistics.fmean(squares)) if squares else float('nan')


def score(track, truth, prefix=''):
    """A dictionary of measures, or None when track and truth have no landmark in common."""
    in_all = set.intersection(*[set(points) for points in truth.values()])
    in_track = set().union(*[points for _, points in track.values()])
    names = sorted(name for name in in_all & in_track if name.startswith(prefix))
    if not names:
        return None
    eyes = first_pair(next(iter(truth.values())), OUTER_EYES)
    size = statistics.fmean(math.dist(points[eyes[0]], points[eyes[1]]) for points in truth.values())
    error = {}
    for k, points in truth.items():
        state, found = track.get(k, ('lost', {}))
        if state != 'lost' and all(name in found for name in names):
            error[k] = statistics.fmean(math.dist(found[name], points[name]) for name in names)
    tracking = sum(1 for k in truth if k in track and track[k][0] == 'tracking')
    bad = [k for k in truth if k not in error or 100 * error[k] / size > FAILURE_NME]
    last = [error[k] for k in sorted(truth)[-100:] if k in error]
    to_nme = 100 / size
    out = {
        'frames': len(truth), 'tracking': tracking, 'points': len(names), 'failed': len(bad),
        'mean_px': statistics.fmean(error.values()), 'nme': to_nme * statistics.fmean(error.values()),
        'nme_p95': to_nme * percentile(error.values(), 0.95), 'nme_last_100': to_nme * statistics.fmean(last) if last else float('nan'),
        'trembling_px': max(0.0, trembling(error, names, lambda j: track[j][1]) - trembling(error, names, lambda j: truth[j])),
    }
    frames = sorted(error)
    estimated = first_pair(track[frames[0]][1], MOUTH)
    annotated = first_pair(truth[frames[0]], MOUTH)
    if estimated and annotated:
        a = [math.dist(track[k][1][estimated[0]], track[k][1][estimated[1]]) for k in frames]
        b = [math.dist(truth[k][annotated[0]], truth[k][annotated[1]]) for k in frames]
        out['mouth_correlation'] = correlation(a, b)
        out['mouth_error_px'] = statistics.fmean(abs(x - y) for x, y in zip(a, b))
    return out


def main(words):
    if len(words) not in (3, 4):
        sys.exit(__doc__)
    measures = score(read_track(words[1]), read_truth(words[2]), words[3] if len(words) == 4 else '')
    if measures is None:
        sys.exit('score.py: no landmark in common')
    print(' '.join('%s=%.4g' % pair for pair in measures.items()))


if __name__ == '__main__':
    main(sys.argv)
