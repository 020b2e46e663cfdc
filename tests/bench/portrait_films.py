#!/usr/bin/env python3
"""Films of portraits with faults: photographs that training never used move in space (portrait_film.py) under light, covers and
cameras that are not good. Tracks them without a start, and says how many frames that show the face are tracked and right, how many
are tracked and wrong, and the landmark error.

usage: portrait_films.py PLIANT FACE.plm PORTRAITS [--people odd|even] [--count N] [--first N] [--kinds NAME;...] [--keep FOLDER]
           [--csv FILE] [TRACK OPTIONS...]
  --people odd|even  by their places in the order of names: odd ones to choose constants, even ones to report (even)
  --count N          people of each kind (8)
  --first N          of these people the first one (0)
  --kinds NAME;...   of KINDS below (all)
  --keep FOLDER      keeps films, tracks and the truth there, and does not draw again what is there
  --csv FILE         a row for each kind and person

Right: an error below 10 % of the distance of the outer corners of the eyes, over the 34 annotated landmarks. Wrong: tracked with a
larger error, or without a face. Where a face leaves the frame, frames in which a landmark is outside do not count as shown.
"""
import csv
import math
import os
import subprocess
import sys
import tempfile

import cv2
import numpy

import portrait_film
import turned_heads as heads
from portrait_film import HEIGHT, WIDTH

FRAMES = 180  # at 25 a second


# --- Motions: pose (yaw, pitch, roll, x, y, distance of the eyes) of frame n ---

def wave(n, period, phase=0.0):
    return math.sin(2 * math.pi * (n / period + phase))


def hand(n, r):
    return (4 * wave(n, 83, r[0]), 3 * wave(n, 67, r[1]), 4 * wave(n, 101, r[2]), 160 + 14 * wave(n, 90, r[3]),
            120 + 8 * wave(n, 70, r[4]), 60 * (1 + 0.05 * wave(n, 110, r[5])))


def turning(n, r):
    return (26 * wave(n, 90, r[0]), 12 * wave(n, 70, r[1])) + hand(n, r)[2:]


def fast(n, r):
    yaw, pitch, roll, _, _, eyes = hand(n, r)
    return 20 * wave(n, 30, r[0]), pitch, 10 * wave(n, 25), 160 + 60 * wave(n, 36, r[3]), 120 + 25 * wave(n, 28, r[4]), eyes


def shaking(n, r):
    draw = numpy.random.RandomState(int(1e6 * r[0]) + int(n))
    yaw, pitch, roll, x, y, eyes = hand(n, r)
    return yaw, pitch, roll + draw.uniform(-2, 2), x + draw.uniform(-8, 8), y + draw.uniform(-8, 8), eyes


def driving(n, r):
    bump = 10 * math.exp(-(n % 47) / 4) * wave(n % 47, 5)
    look = wave(n, 75, r[0]) ** 3  # aside, now and then
    return (22 * look, 3 * wave(n, 21) + 0.3 * bump, 2 * wave(n, 33),
            160 + 5 * wave(n, 17, r[3]), 120 + 4 * wave(n, 11, r[4]) + bump, 60)


def nearing(n, r):
    yaw, pitch, roll, x, y, _ = hand(n, r)
    return yaw, pitch, roll, 160 + (x - 160) / 2, 120 + (y - 120) / 2, 60 * 2 ** (1.2 * wave(n, 100, r[0]))


def rolling(n, r):
    yaw, pitch, _, x, y, eyes = hand(n, r)
    return yaw, pitch, 40 * wave(n, 80, r[2]), x, y, eyes


def small(n, r):
    return hand(n, r)[:5] + (28,)


def leaving(n, r):
    yaw, pitch, roll, x, y, eyes = hand(n, r)
    return yaw, pitch, roll, x + 400 * max(0, wave(n, 180, -0.2)) ** 3, y, eyes


def cut(n, r, moves):
    """Every 30 frames the film is cut to another size of the face, from 36 to 84 px, and with `moves` to another place."""
    yaw, pitch, roll, x, y, eyes = hand(n, r)
    draw = numpy.random.RandomState(int(1e6 * r[0]) + int(n) // 30)
    size = 60 * 2 ** draw.uniform(-0.7, 0.5)
    room = max(0, 1 - size / 90) if moves else 0
    return (yaw, pitch, roll, x + 110 * room * draw.uniform(-1, 1), y + 70 * room * draw.uniform(-1, 1), size / 60 * eyes)


def cut_size(n, r):
    return cut(n, r, False)


def cut_size_and_place(n, r):
    return cut(n, r, True)


# --- Faults: f(frame, n, state) changes a frame; state keeps what lasts: a random generator, the frame before, the landmarks ---

def grid():
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH].astype(numpy.float32)
    return x, y


X, Y = grid()


def smooth_noise(draw, cell, rows=HEIGHT, columns=WIDTH):
    small_noise = draw.uniform(0, 1, (rows // cell + 4, columns // cell + 4)).astype(numpy.float32)
    return cv2.resize(small_noise, None, fx=cell, fy=cell, interpolation=cv2.INTER_CUBIC)[:rows, :columns]


def exposure(stops, period):
    return lambda f, n, s: f * 2 ** (stops * wave(n, period))


def settling(extra, frames):
    return lambda f, n, s: f * (1 + extra * math.exp(-n / frames))


def light(gain):
    return lambda f, n, s: f * gain


def one_sided(gain):
    return lambda f, n, s: f * (1 + gain / (1 + numpy.exp(-(X - s['points'][:, 0].mean()) / 6)))


def trees(speed):
    def apply(f, n, s):
        if 'leaves' not in s:
            s['leaves'] = smooth_noise(s['draw'], 24, HEIGHT, WIDTH + int(speed * FRAMES) + 1)
        at = int(speed * n)
        shade = numpy.clip((s['leaves'][:, at:at + WIDTH] - 0.5) * 6 + 0.5, 0, 1)
        return f * (0.35 + 0.85 * shade)
    return apply


def side_sun(f, n, s):
    return f * numpy.clip(1 + 0.8 * wave(n, 100) * (X - s['points'][:, 0].mean()) / 50, 0.25, 1.9)


def moving_spot(f, n, s):
    x, y = s['points'].mean(0) + (50 * wave(n, 60), 30 * wave(n, 95))
    return f + 170 * numpy.exp(-((X - x) ** 2 + (Y - y) ** 2) / (2 * 18 ** 2))


def every_fourth(gain):
    return lambda f, n, s: f * (gain if n % 4 == 3 else 1)


def screen_light(f, n, s):
    level = numpy.random.RandomState(n // 9).uniform(0.5, 1.5)
    return f * (0.6 + 0.5 * level * (0.5 + X / WIDTH if n // 9 % 2 else 1.5 - X / WIDTH))


def bands(depth, width):
    return lambda f, n, s: f * (1 - depth / 2 + depth / 2 * numpy.sin(2 * math.pi * (Y / (2 * width) + n * 0.23)))


def fog(f, n, s):
    return 100 + 0.25 * (f - 100)


def gamma(f, n, s):
    return 255 * (numpy.clip(f, 0, 255) / 255) ** (2 ** (0.9 * wave(n, 70)))


def focus(largest):
    def apply(f, n, s):
        sd = largest * (0.5 - 0.5 * math.cos(2 * math.pi * n / 60))
        return cv2.GaussianBlur(f, (0, 0), sd) if sd > 0.3 else f
    return apply


def dirty_lens(f, n, s):
    if 'dirt' not in s:
        s['dirt'] = numpy.clip((smooth_noise(s['draw'], 40) - 0.55) * 8, 0, 1)
    return f * (1 - s['dirt']) + s['dirt'] * (0.6 * cv2.GaussianBlur(f, (0, 0), 7) + 50)


def drops(f, n, s):
    if 'drops' not in s:
        s['drops'] = [(s['draw'].uniform(60, 260), s['draw'].uniform(30, 210), s['draw'].uniform(5, 11)) for _ in range(14)]
    inside = sum(numpy.exp(-(((X - x) ** 2 + (Y - y) ** 2) / r ** 2) ** 3) for x, y, r in s['drops']).clip(0, 1)
    return f * (1 - inside) + inside * cv2.flip(cv2.GaussianBlur(f, (0, 0), 4), -1)


def noise(sd):
    return lambda f, n, s: f + s['draw'].normal(0, sd, f.shape)


def line_noise(f, n, s):
    return f + s['draw'].normal(0, 6, (HEIGHT, 1)) + numpy.random.RandomState(7).normal(0, 6, (1, WIDTH))


def dead_pixels(f, n, s):
    draw, g = numpy.random.RandomState(3), f.copy()
    g[draw.randint(0, HEIGHT, 400), draw.randint(0, WIDTH, 400)] = 255
    g[:, draw.randint(0, WIDTH, 3)] = 0
    return g


def jpeg(quality):
    def apply(f, n, s):
        coded = cv2.imencode('.jpg', numpy.clip(f, 0, 255).astype(numpy.uint8), [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        return cv2.imdecode(coded, cv2.IMREAD_GRAYSCALE).astype(numpy.float32)
    return apply


def torn(f, n, s):
    before, s['before'] = s.get('before', (f, s['points'])), (f, s['points'])
    if n % 3 != 2:
        return f
    g, row = f.copy(), (n * 37) % HEIGHT
    g[row:] = before[0][row:]
    s['points'] = numpy.where(s['points'][:, 1:] < row, s['points'], before[1])
    return g


def bad_bytes(f, n, s):
    if n % 10 != 9:
        return f
    g, begin = f.copy(), s['draw'].randint(0, HEIGHT - 60)
    g[begin:begin + 60] = s['draw'].uniform(0, 255, (60, WIDTH))
    return g


def covered(shape, from_frame, to_frame, grey=None):
    """A cover that follows the face: `shape` gives its distance in units of the eyes' distance, inside below 0."""
    def apply(f, n, s):
        if not from_frame <= n < to_frame:
            return f
        p = dict(zip(s['names'], s['points']))
        right, left = p['ibug36'], p['ibug45']
        unit = numpy.hypot(*(left - right))
        e = (left - right) / unit
        d = (X - (right + left)[0] / 2, Y - (right + left)[1] / 2)
        a, b = (d[0] * e[0] + d[1] * e[1]) / unit, (d[1] * e[0] - d[0] * e[1]) / unit
        inside = numpy.clip(0.5 - shape(a, b) * unit / 2, 0, 1)
        if 'weave' not in s:
            s['weave'] = 25 * (smooth_noise(s['draw'], 8, 400, 400) - 0.5)
        weave = cv2.remap(s['weave'], (200 + 60 * a).astype(numpy.float32), (200 + 60 * b).astype(numpy.float32), cv2.INTER_LINEAR)
        return f * (1 - inside) + inside * ((grey or 150) + weave)
    return apply


def face_mask(a, b):
    return numpy.maximum(numpy.abs(a) - 0.85 + 0.2 * (b - 0.5), numpy.maximum(0.42 - b + 0.1 * numpy.abs(a), b - 1.7))


def glasses(a, b):
    return numpy.minimum(numpy.hypot(numpy.abs(a) - 0.36, b) - 0.27, numpy.maximum(numpy.abs(b) - 0.03, numpy.abs(a) - 0.9))


def fingers(a, b):
    return numpy.minimum.reduce([numpy.maximum(numpy.abs(b - 0.8 - 0.13 * k - 0.1 * a) - 0.055, -0.25 - a) for k in range(4)])


def half(a, b):
    return -a + 0.05


def hat(low, brim):
    """A crown whose lower edge is that high above the eyes, and a brim that reaches that far to the sides."""
    def shape(a, b):
        crown = numpy.maximum(numpy.abs(a) - 0.8 + 0.1 * b, numpy.maximum(b + low, -1.7 - b))
        return numpy.minimum(crown, 0.13 * (numpy.hypot(a / brim, (b + low - 0.05 * a * a) / 0.13) - 1))
    return shape


def shade(low, factor):
    """Of a brim: what is less far below the eyes is darker."""
    def apply(f, n, s):
        p = dict(zip(s['names'], s['points']))
        right, left = p['ibug36'], p['ibug45']
        unit = numpy.hypot(*(left - right))
        e, middle = (left - right) / unit, (right + left) / 2
        b = ((Y - middle[1]) * e[0] - (X - middle[0]) * e[1]) / unit
        lit = numpy.clip((b - low) / 0.2, 0, 1)
        return f * (factor + (1 - factor) * lit)
    return apply


def arm(f, n, s):
    at = -200 + 9 * (n % 80)
    inside = numpy.clip(20 - numpy.abs(X - at + (Y - 120) / 3) / 1.2, 0, 1)
    return f * (1 - inside) + inside * (120 + 20 * (Y % 23 > 11))


def gone(begin, end):
    def apply(f, n, s):
        s['absent'] = begin <= n < end
        return s['background'] * 1.0 if s['absent'] else f
    return apply


def black(begin, end):
    def apply(f, n, s):
        s['absent'] = begin <= n < end
        return f * 0 if s['absent'] else f
    return apply


def whole(a, b):
    return numpy.hypot(a, (b - 0.5) / 1.3) - 1.2


def hidden(begin, end):
    """Something before the whole face."""
    cover = covered(whole, begin, end)

    def apply(f, n, s):
        s['absent'] = begin <= n < end
        return cover(f, n, s)
    return apply


def someone_else(begin, fade):
    """Another person from a frame on, who fades in over so many frames; the faces count as shown, each in its half of the fade."""
    def apply(f, n, s):
        part = min(1, max(0, (n - begin + 1) / (fade + 1)))
        if part == 0:
            return f
        frame, points = s['other'](n)
        if part >= 0.5:
            s['points'] = points
        return (1 - part) * f + part * frame
    return apply


QUIET = noise(2)
KINDS = {  # name: motion, faults, samples of a shutter that is open for half of a frame's time (0: no motion blur)
    'quiet': (hand, [], 0),
    'turning': (turning, [], 0),
    'fast, motion blur': (fast, [], 5),
    'shaking': (shaking, [], 0),
    'driving': (driving, [], 3),
    'driving, tree shadows': (driving, [trees(9)], 3),
    'turning, tree shadows': (turning, [trees(5)], 0),
    'tree shadows': (hand, [trees(4)], 0),
    'nearing': (nearing, [], 0),
    'rolling': (rolling, [], 0),
    'cuts to other sizes': (cut_size, [], 0),
    'cuts to other sizes and places': (cut_size_and_place, [], 0),
    'small': (small, [], 0),
    'small, jpeg 20': (small, [jpeg(20)], 0),
    'exposure 1.2 stops': (hand, [exposure(1.2, 50)], 0),
    'exposure 1.8 stops': (hand, [exposure(1.8, 50)], 0),
    'exposure settles': (hand, [settling(1.5, 6)], 0),
    'exposure settles slowly': (hand, [settling(0.7, 20)], 0),
    'a lamp, 1.8 times the light': (hand, [light(1.8)], 0),
    'a lamp from one side': (turning, [one_sided(2.2)], 0),
    'sun from changing sides': (hand, [side_sun], 0),
    'turning, sun from changing sides': (turning, [side_sun], 0),
    'moving spot of light': (hand, [moving_spot], 0),
    'every fourth bright': (hand, [every_fourth(2.6)], 0),
    'light of a screen': (hand, [light(0.5), screen_light], 0),
    'bands 60 %': (hand, [bands(0.6, 120)], 0),
    'narrow bands 50 %': (hand, [bands(0.5, 60)], 0),
    'narrow bands, shaking': (shaking, [bands(0.5, 60)], 0),
    'fog': (turning, [fog], 0),
    'gamma': (turning, [gamma], 0),
    'focus': (hand, [focus(4.7)], 0),
    'turning, focus': (turning, [focus(3)], 0),
    'dirty lens': (turning, [dirty_lens], 0),
    'drops on the lens': (turning, [drops], 0),
    'low light, noise 9': (hand, [light(0.25), noise(9)], 0),
    'turning, low light, noise 7': (turning, [light(0.3), noise(7)], 0),
    'lines of noise': (turning, [line_noise], 0),
    'dead pixels': (turning, [dead_pixels], 0),
    'jpeg 10': (turning, [jpeg(10)], 0),
    'torn frames': (fast, [torn], 0),
    'bad bytes': (turning, [bad_bytes], 0),
    'mask from the start': (hand, [covered(face_mask, 0, 999)], 0),
    'mask, then off': (hand, [covered(face_mask, 0, 60)], 0),
    'mask put on': (turning, [covered(face_mask, 60, 999)], 0),
    'dark glasses': (turning, [covered(glasses, 0, 999, 30)], 0),
    'fingers, then off': (hand, [covered(fingers, 0, 60)], 0),
    'half behind a door, then out': (hand, [covered(half, 0, 60)], 0),
    'fingers come and go': (turning, [covered(fingers, 40, 80), covered(fingers, 100, 140)], 0),
    'hat': (turning, [shade(0.3, 0.35), covered(hat(0.3, 1.4), 0, 999, 40)], 0),
    'hat, fog': (turning, [shade(0.3, 0.5), covered(hat(0.35, 1.3), 0, 999, 40), fog], 0),
    'cap over the brows': (turning, [shade(0.2, 0.5), covered(hat(0.22, 0.9), 0, 999, 60)], 0),
    'pale cap': (turning, [shade(0.5, 0.6), covered(hat(0.25, 0.8), 0, 999, 200)], 0),
    'arm': (hand, [arm], 0),
    'hidden for a second': (hand, [hidden(60, 85)], 0),
    'leaves and returns': (leaving, [], 0),
    'another person': (hand, [someone_else(90, 0)], 0),
    'another person, elsewhere': (small, [someone_else(90, 0)], 0),
    'another person fades in': (turning, [someone_else(84, 12)], 0),
    'gone for a second': (turning, [gone(60, 85)], 0),
    'black for half a second': (turning, [black(60, 73)], 0),
}


# --- Drawing, tracking, scoring ---

def background(draw):
    return 40 + 140 * (0.6 * smooth_noise(draw, 60) + 0.4 * smooth_noise(draw, 14)).clip(0, 1)


def draw_motion(portrait, motion, samples, seed):
    """The frames without faults, and the true landmarks of each."""
    draw = numpy.random.RandomState(seed)
    phases = draw.uniform(0, 1, 6)
    behind = background(draw)
    frames, truth = [], []
    for n in range(FRAMES):
        times = [n + 0.5 * (k / samples - 0.5) for k in range(samples)] if samples else [n]
        shown = [portrait.frame(motion(t, phases), behind) for t in times]
        frames.append(sum(f for f, _ in shown) / len(shown))
        truth.append(sum(p for _, p in shown) / len(shown))
    return frames, truth, behind


class Motions:
    """The motions of a person, each drawn once."""

    def __init__(self, portrait, seed):
        self.portrait, self.seed, self.drawn = portrait, seed, {}

    def draw(self, motion, samples):
        if (motion, samples) not in self.drawn:
            self.drawn[motion, samples] = draw_motion(self.portrait, motion, samples, self.seed)
        return self.drawn[motion, samples]

    def frame(self, motion, n):
        frames, points, _ = self.draw(motion, 0)
        return frames[n], points[n]


def draw_film(path, kind, person, other):
    """Writes the film and gives each frame's true landmarks, or NaN where the face is absent."""
    motion, faults, samples = KINDS[kind]
    frames, points, behind = person.draw(motion, samples)
    state = {'draw': numpy.random.RandomState(person.seed + 1000), 'background': behind, 'names': person.portrait.names,
             'other': lambda n: other.frame(hand, n)}
    truth = []
    with open(path, 'wb') as out:
        out.write(b'YUV4MPEG2 W%d H%d F25:1 Ip A1:1 Cmono\n' % (WIDTH, HEIGHT))
        for n, frame in enumerate(frames):
            state['points'] = points[n]
            for fault in faults + [QUIET]:
                frame = fault(frame, n, state)
            truth.append(state['points'] * (math.nan if state.get('absent') else 1))
            out.write(b'FRAME\n' + numpy.clip(frame + 0.5, 0, 255).astype(numpy.uint8).tobytes())
    return truth


def score(rows, truth, names):
    """Of the rows of a track, frames: shown, tracked and right, tracked and wrong; and the errors of the right ones, %."""
    shown = right = wrong = 0
    errors = []
    for points, row in zip(truth, rows):
        tracking = row['state'] == 'tracking'
        error, inside = 100.0, False
        if not numpy.isnan(points[0, 0]):
            inside = (points >= 0).all() and (points < (WIDTH, HEIGHT)).all()
            shown += inside
            if tracking:
                found = numpy.array([(float(row['x_' + n]), float(row['y_' + n])) for n in names])
                eyes = numpy.hypot(*(points[names.index('ibug36')] - points[names.index('ibug45')]))
                error = 100 * float(numpy.hypot(*(found - points).T).mean()) / max(eyes, 1)
        if tracking and error < 10:
            right += inside
            errors.append(error)
        wrong += tracking and error >= 10
    return shown, right, wrong, errors


def run(pliant, face, kind, person, other, folder, options):
    film, track, kept = (os.path.join(folder, n) for n in ('film.y4m', 'track.csv', 'truth.npy'))
    if not os.path.exists(kept):
        numpy.save(kept, draw_film(film, kind, person, other))
    subprocess.run([pliant, 'track', face, '--frames', film, '--landmarks', '--out', track] + options, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(track) as lines:
        return score(csv.DictReader(lines), numpy.load(kept), person.portrait.names)


def run_person(pliant, face, kinds, person, other, keep, options):
    """What `score` says of each kind."""
    results = []
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            if keep:
                folder = os.path.join(keep, '%s-%s' % (person.portrait.name, kind.replace(' ', '_').replace(',', '')))
                os.makedirs(folder, exist_ok=True)
            results.append(run(pliant, face, kind, person, other, folder, options))
    return results


def main(argv):
    options = {'--people': 'even', '--count': '8', '--first': '0', '--kinds': '', '--keep': '', '--csv': ''}
    pliant, face, portraits, *more = heads.arguments(argv, options, __doc__)
    if options['--people'] not in ('odd', 'even'):
        sys.exit(__doc__)
    kinds = options['--kinds'].split(';') if options['--kinds'] else list(KINDS)
    landmarks = portrait_film.read_landmarks(portraits)
    first, count = int(options['--first']), int(options['--count'])
    people = sorted(landmarks)[options['--people'] == 'odd'::2][first:first + count]
    surface = portrait_film.model_surface(pliant, face)
    rows, of_kinds = [], [[] for _ in kinds]
    everybody = [portrait_film.Portrait(portraits, name, landmarks[name], surface) for name in people]
    for k, portrait in enumerate(everybody):
        person, other = Motions(portrait, first + k), Motions(everybody[k - 1], first + k + 500)
        for of_kind, result in zip(of_kinds, run_person(pliant, face, kinds, person, other, options['--keep'], more)):
            of_kind.append(result)
    print('| kind | tracked and right, % | wrong frames | landmarks, median, % | worst person: right, % |')
    print('|---|---:|---:|---:|---:|')
    for kind, results in zip(kinds, of_kinds):
        rows += [[kind, name, *r[:3], '%.3f' % numpy.median(r[3]) if r[3] else ''] for name, r in zip(people, results)]
        shown, right, wrong = (sum(r[k] for r in results) for k in range(3))
        errors = [e for r in results for e in r[3]]
        print('| %s | %.1f | %d | %.2f | %.1f |' % (kind, 100 * right / shown, wrong, numpy.median(errors) if errors else math.nan,
                                                   min(100 * r[1] / r[0] for r in results)))
    if options['--csv']:
        with open(options['--csv'], 'w', newline='') as out:
            csv.writer(out).writerows([['kind', 'person', 'shown', 'right', 'wrong', 'error']] + rows)


if __name__ == '__main__':
    main(sys.argv[1:])
