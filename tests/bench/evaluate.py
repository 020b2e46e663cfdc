#!/usr/bin/env python3
"""Measures the library and writes the tables of docs/evaluation.md.

usage: python3 tests/bench/evaluate.py [--only SECTION,...] [--long] [--build FOLDER] [--data FOLDER]
                                       [--others FOLDER] [--face-films FILM,...] [--klt-pairs FOLDER]
                                       [--films FOLDER] [--fit-problems FOLDER] [--list]
  --only SECTION,...   renew these sections and keep the others (all)
  --long               also what takes more than a few minutes: Figure 9 on the recorded face, the second model
  --build FOLDER       a release build (build/release); what is missing in it is built
  --data FOLDER        recorded faces; else the environment's PLIANT_DATA
  --others FOLDER      photographs without faces (fixtures/face/other_pictures.sh fetches some)
  --face-films FILM,...   further films of one face, for faults
  --klt-pairs FOLDER   pairs of pictures with known motion (pliant bench klt --pairs)
  --films FOLDER       films of sheets (sheet_film.py): subfolders paper-A, occluded-A, cloth-A, paper-B, occluded-B, cloth-B; what
                       is missing is rendered by Blender into it, an hour each
  --fit-problems FOLDER   fitting problems with their optima (pliant bench fit --problems)
  --list               print the names of the sections

Python's standard library is enough. A section whose data or tools are missing keeps the table it has, or says what is
missing. The rest of the document is left as it is: only what stands between <!-- measured: NAME --> and
<!-- end of NAME --> is replaced. Takes about ten minutes on an idle machine without --long.
"""
import argparse
import csv
import io
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import time

sys.dont_write_bytecode = True
import eyes  # noqa: E402
import score  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DOCUMENT = os.path.join(ROOT, 'docs', 'evaluation.md')


class Missing(Exception):
    """Data or a tool that a section needs is not there."""


class Setup:
    def __init__(self, options, work):
        self.options = options
        self.work = work
        self.build = os.path.abspath(os.path.join(ROOT, options.build))
        self.pliant = os.path.join(self.build, 'pliant')
        self.data = options.data
        self.face = os.path.join(work, 'face.plm')

    def path(self, name):
        return os.path.join(self.work, name)

    def program(self, name):
        """A program of tests/bench, built when it is not there or older than its source."""
        path = os.path.join(self.build, 'tests', name)
        if run(['cmake', '--build', self.build, '--target', name], must=False).returncode != 0 or not os.path.exists(path):
            raise Missing('the program %s, which this build leaves out' % name)
        return path

    def pliant_output(self, *words):
        return run([self.pliant, *words]).stdout


def run(command, must=True, stdin=None, cwd=None):
    result = subprocess.run(command, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd)
    if must and result.returncode != 0:
        tail = (result.stderr.strip().splitlines() or ['no message'])[-1]
        raise Missing('`%s` failed: %s' % (os.path.basename(command[0]) + ' ' + ' '.join(command[1:3]), tail))
    return result


def tool(name):
    if shutil.which(name) is None:
        raise Missing('the program %s' % name)
    return name


def folder(path, what):
    if not path or not os.path.isdir(path):
        raise Missing(what)
    return path


# --- Tables ---

def number(text):
    """Four significant digits; words as they are."""
    try:
        value = float(text)
    except ValueError:
        return text
    if value == int(value) and abs(value) < 1e15:
        return str(int(value))
    return '%.4g' % value if abs(value) < 1000 else '%.0f' % value


def table(header, rows, left=1):
    lines = ['| ' + ' | '.join(header) + ' |',
             '|' + '|'.join('---' if i < left else '---:' for i in range(len(header))) + '|']
    lines += ['| ' + ' | '.join(str(cell) for cell in row) + ' |' for row in rows]
    return '\n'.join(lines)


def wrapped(text):
    """The text with its prose in lines as long as those of the rest of the document; tables and commands as they are."""
    lines = (line if line.startswith(('|', '    ')) else textwrap.fill(line, 132, break_long_words=False, break_on_hyphens=False)
             for line in text.split('\n'))
    return '\n'.join(lines)


def bench_rows(text):
    """(variant, metric, value) of the rows that `pliant bench` prints."""
    return [(r['variant'], r['metric'], r['value']) for r in csv.DictReader(io.StringIO(text))]


def pivot(rows, first='variant', keep=None):
    """A row a variant, a column a metric."""
    variants = list(dict.fromkeys(v for v, _, _ in rows))
    metrics = [m for m in dict.fromkeys(m for _, m, _ in rows) if keep is None or m in keep]
    values = {(v, m): x for v, m, x in rows}
    variants = [v for v in variants if any((v, m) in values for m in metrics)]
    return table([first] + [m.replace('_', ' ') for m in metrics],
                 [[v.replace('_', ' ')] + [number(values.get((v, m), '')) for m in metrics] for v in variants])


def pairs_of(line):
    return dict(word.split('=', 1) for word in line.split() if '=' in word)


def command_block(*lines):
    return '\n'.join('    ' + line for line in lines)


# --- Sections ---

def machine(s):
    model = platform.processor() or platform.machine()
    try:
        with open('/proc/cpuinfo') as file:
            model = re.search(r'model name\s*:\s*(.*)', file.read()).group(1)
    except (OSError, AttributeError):
        pass
    with open(os.path.join(s.build, 'CMakeCache.txt')) as cache:
        compiler = re.search(r'^CMAKE_CXX_COMPILER:[A-Z]+=(.*)$', cache.read(), re.M).group(1)
    version = run([compiler, '--version']).stdout.splitlines()[0]
    load = os.getloadavg()[0] if hasattr(os, 'getloadavg') else 0
    rows = [['processor', model], ['cores', os.cpu_count()], ['load when this began', '%.1f' % load],
            ['system', '%s %s' % (platform.system(), platform.machine())], ['compiler', version],
            ['build', 'CMake preset `release`'], ['library', run([s.pliant, '--version']).stdout.strip()]]
    return table(['', ''], rows, 2)


def demo(s):
    out = run(['sh', os.path.join(ROOT, 'fixtures', 'demo.sh')]).stdout
    rows = [re.split(r'\s{2,}', line.strip(), maxsplit=1) for line in out.splitlines()
            if re.match(r'^[a-z ]+\s{2,}\S', line)]
    return command_block('sh fixtures/demo.sh') + '\n\n' + table(['', ''], rows)


def franck_points(s, kind, first, count):
    """Writes start, markers and truth of the recorded face; gives their paths."""
    base = folder(s.data and os.path.join(s.data, 'franck'), 'the recorded face (folder `franck` in PLIANT_DATA)')
    ibug = {}
    with open(os.path.join(base, 'fgnet68_to_ict.csv')) as file:
        for row in csv.reader(file):
            if row and not row[0].startswith('#'):
                ibug[int(row[0])] = 'ibug%02d' % int(row[1])
    paths = {name: s.path('%s_%s.csv' % (kind, name)) for name in ('points', 'markers', 'truth')}
    with open(os.path.join(base, 'points_%s.csv' % kind)) as file, open(paths['points'], 'w') as points, \
            open(paths['markers'], 'w') as markers, open(paths['truth'], 'w') as truth:
        points.write('landmark,x,y\n')
        markers.write('landmark,x,y\n')
        truth.write('frame,landmark,x,y\n')
        for row in list(csv.reader(file))[1:]:
            k = int(row[0]) - first
            if not 0 <= k < count:
                continue
            for i in range(68):
                x, y = row[1 + 2 * i], row[2 + 2 * i]
                truth.write('%d,fgnet%02d,%s,%s\n' % (k, i, x, y))
                if i in ibug:
                    truth.write('%d,%s,%s,%s\n' % (k, ibug[i], x, y))
                if k == 0 and i in ibug:
                    points.write('%s,%s,%s\n' % (ibug[i], x, y))
                if k == 0 and i > 14 and i not in (31, 36):  # neither the sliding outline of the cheeks nor the pupils
                    markers.write('fgnet%02d,%s,%s\n' % (i, x, y))
    return base, paths


def franck_film(s, kind, base, frames):
    film = s.path(kind + '.y4m')
    if not os.path.exists(film):
        source = ['-i', os.path.join(base, 'franck.mp4')] if kind == 'mp4' else \
            ['-framerate', '25', '-i', os.path.join(base, 'frames', 'franck_%05d.jpg')]
        run([tool('ffmpeg'), '-loglevel', 'error', '-y', *source, '-frames:v', str(frames), '-f', 'yuv4mpegpipe', '-pix_fmt', 'gray',
             film])
    return film


SEQUENCES = (('original', 500, 'originals 0-499, 720x576', '8'), ('mp4', 2400, 'video 0-2399, 360x288', '4'))


def track_recorded(s, model, kind, frames, exclusion, extra=()):
    base, paths = franck_points(s, kind, 0, frames)
    film = franck_film(s, kind, base, frames)
    out = s.path('track.csv')
    with_markers = exclusion is not None
    words = ['track', model, '--frames', film, '--init', paths['points'], '--out', out, *extra]
    words += ['--markers', paths['markers'], '--marker-exclusion-px', exclusion] if with_markers else ['--landmarks']
    summary = pairs_of(run([s.pliant, *words]).stdout.strip().splitlines()[-1])
    measures = score.score(score.read_track(out), score.read_truth(paths['truth']), 'fgnet' if with_markers else 'ibug')
    return summary, measures


def recorded_rows(s, model, label):
    rows = []
    for with_markers in (False, True):
        for kind, frames, name, exclusion in SEQUENCES:
            summary, m = track_recorded(s, model, kind, frames, exclusion if with_markers else None)
            rows.append([label, name, '%d %s' % (m['points'], 'markers, exclusion %s px' % exclusion if with_markers else 'landmarks'),
                         '%d of %d' % (m['tracking'], m['frames']), '%.2f' % m['nme'], '%.2f' % m['nme_p95'], '%.2f' % m['nme_last_100'],
                         '%.2f' % m['mouth_correlation'] if 'mouth_correlation' in m else '', '%.2f' % m['trembling_px'],
                         summary.get('median_ms', ''), summary.get('arena_bytes', ''), summary.get('peak_kib', '')])
    return rows


RECORDED_HEADER = ['model', 'sequence', 'points', 'in tracking', 'NME %', 'at 95 %', 'last 100', 'mouth', 'trembling px', 'ms a frame',
                   'arena bytes', 'process KiB']


def recorded(s):
    rows = recorded_rows(s, s.face, 'built-in')
    if s.options.long:
        ict = os.path.join(s.data or '', 'ict')
        if os.path.exists(os.path.join(ict, 'to_obj.py')):
            source, model = s.path('ict'), s.path('ict.plm')
            run([sys.executable, os.path.join(ict, 'to_obj.py'), source], cwd=ict)
            run([s.pliant, 'bake', source, '-o', model, '--unit', '10'])
            rows += recorded_rows(s, model, 'ICT-FaceKit, 155 parameters')
    else:  # they take long, and stay as they are
        with open(DOCUMENT) as file:
            lines = block(file.read(), 'recorded').splitlines()
        rows += [[cell.strip() for cell in line.strip('|').split('|')] for line in lines if line.startswith('| ICT')]
    text = [command_block('ffmpeg -i franck.mp4 -frames:v 2400 -f yuv4mpegpipe -pix_fmt gray - |',
                          '  pliant track face.plm --frames - --init points.csv --landmarks --out track.csv',
                          'python3 tests/bench/score.py track.csv truth.csv ibug'),
            '', table(RECORDED_HEADER, rows, 3), '']
    try:
        floor = s.program('tracking_floor')
        _, paths = franck_points(s, 'mp4', 0, 2400)
        lines = run([floor, s.face, '360x288', paths['points'], paths['truth'], paths['markers']]).stdout.splitlines()
        text += ['Lower limit: the model fitted to the annotated points of every frame of the video, identity from frame 0 '
                 '(`tracking_floor`).', '',
                 table(['points', 'NME %'], [['%s %s' % (pairs_of(l)['points'], l.split(':')[0]), '%.2f' % float(pairs_of(l)['nme'])]
                                             for l in lines])]
    except Missing as reason:
        print('  kept as it is: the lower limit: %s' % reason, file=sys.stderr)
        with open(DOCUMENT) as file:
            text += re.findall(r'^Lower limit.*?(?=^Measured )', block(file.read(), 'recorded'), re.S | re.M)
    return '\n'.join(text)


def recorded_variants(s):
    variants = (('default', ()), ('patches only', ('--cues', 'patch')), ('patches and flow', ('--cues', 'patch,flow')),
                ('patches and edges', ('--cues', 'patch,edge')), ('expression constant', ('--freeze', 'expression')),
                ('identity as started', ('--freeze', 'identity')))
    rows = []
    for name, extra in variants:
        try:
            row = [name]
            for kind, frames, _, _ in SEQUENCES:
                _, m = track_recorded(s, s.face, kind, frames, None, extra)
                row += ['%.2f' % m['nme'], '%.2f' % m['mouth_correlation'], '%.2f' % m['mouth_error_px']]
            rows.append(row)
        except Missing as reason:
            if not rows:
                raise
            print('  left out: %s: %s' % (name, reason), file=sys.stderr)
    header = ['configuration'] + ['%s, %s' % (size, what) for size in ('720x576', '360x288') for what in ('NME %', 'mouth', 'mouth px')]
    return table(header, rows)


def recorded_eyes(s):
    base, paths = franck_points(s, 'mp4', 0, 2400)
    film, out = franck_film(s, 'mp4', base, 2400), s.path('track.csv')
    labels = os.path.join(base, 'blinks_mp4.csv')
    rows = []
    for start, words in (('25 annotated points', ('--init', paths['points'])), ('found without points', ())):
        text = run([s.pliant, 'track', s.face, '--frames', film, *words, '--landmarks', '--out', out]).stdout
        m = eyes.score_eyes(out, paths['truth'], labels, float(pairs_of(text.strip().splitlines()[-1])['f_px']))
        rows.append([start, '%d of %d' % (m['found'], m['blinks']), str(m['false']), str(m['late_frames']),
                     '%.3f / %.3f' % (m['gap_right'], m['gap_left']), str(m['gaze_frames']),
                     '%.1f, %.1f, %.2f' % (m['gaze_up_mean'], m['gaze_up_sd'], m['gaze_up'])])
    return table(['start', 'blinks found', 'false', 'closing late, frames', 'gap, right / left', 'frames with a gaze',
                  'gaze up: mean, sd, correlation'], rows)


def figure9_tables(text):
    out = []
    for part in text.split('\n# ')[1:]:
        title, *lines = part.strip().splitlines()
        split = next(i for i, line in enumerate(lines) if line.startswith('claim,'))
        out.append('**%s**\n' % title.capitalize())
        cells = [line.split(',') for line in lines[:split]]
        out.append(table([c.replace('_', ' ') for c in cells[0]], [[number(c) for c in row] for row in cells[1:]]) + '\n')
        claims = [line.split(',') for line in lines[split:] if line.count(',') >= 4 and not line.startswith('contour / ')]
        ratios = [line for line in lines[split:] if line.startswith('contour / ')]
        out.append(table([c.replace('_', ' ') for c in claims[0]], [[number(c) for c in row] for row in claims[1:]], 2) + '\n')
        out += [line + '.\n' for line in ratios]
    return '\n'.join(out)


def figure9(s):
    program = s.program('figure9')
    text = command_block('tests/figure9 face.plm FOLDER 900') + '\n\n' + figure9_tables(run([program, s.face, s.work, '900']).stdout)
    plot = s.path('figure9_rendered_vertices.svg')
    if os.path.exists(plot):
        shutil.copy(plot, os.path.join(ROOT, 'fixtures', 'pictures', 'figure9.svg'))
    return text.rstrip()


def figure9_recorded(s):
    program = s.program('figure9')
    base, paths = franck_points(s, 'mp4', 0, 1800)
    film = franck_film(s, 'mp4', base, 2400)
    out = run([program, s.face, s.work, '900', film, '2', paths['points'], paths['markers'], paths['truth']]).stdout
    return command_block('tests/figure9 face.plm FOLDER 900 film.y4m 2 points.csv markers.csv truth.csv') + '\n\n' + figure9_tables(out).rstrip()


def mesh_table(s):
    return command_block('pliant mesh face.plm --curve') + '\n\n' + s.pliant_output('mesh', s.face, '--curve').strip()


def bench(topic, *words, keep=None, first='variant'):
    def measure(s):
        rows = bench_rows(s.pliant_output('bench', topic, *(w.replace('FACE', s.face) for w in words)))
        shown = ' '.join(w.replace('FACE', 'face.plm') for w in words)
        return command_block(('pliant bench %s %s' % (topic, shown)).strip()) + '\n\n' + pivot(rows, first, keep)
    return measure


def mesh_operations(s):
    rows = bench_rows(s.pliant_output('bench', 'mesh', '--model', s.face))
    lines = [[v.replace('_', ' '), m.replace('_', ' '), number(x)] for v, m, x in rows]
    return command_block('pliant bench mesh --model face.plm') + '\n\n' + table(['operation', 'measure', 'value'], lines, 2)


MCD_METHODS = ('median ball', 'all six', 'fast 500')


def mcd_table(rows):
    """A row a size, a column a method: ms, and in brackets the runs that missed the lowest known determinant."""
    cells, missed = {}, 0
    for variant, metric, value in rows:
        method, size, alpha, exchanges = re.match(r'(.*) (\d+x\d+) (0\.\d+)( exchanges)?$', variant.replace('_', ' ')).groups()
        cell = cells.setdefault((size, alpha), {}).setdefault(method + (exchanges or ''), {})
        cell[metric] = value
    columns = [method + more for method in MCD_METHODS for more in ('', ' exchanges')]
    lines = []
    for (size, alpha), found in cells.items():
        shown = []
        for column in columns:
            count = int(float(found[column]['missed']))
            missed += count
            shown.append(number(found[column]['ms']) + (' (%d)' % count if count else ''))
        lines.append([size, alpha] + shown)
    return table(['rows x columns', 'alpha'] + columns, lines, 2) + '\n\nRuns that missed the lowest known determinant: %d.' % missed


def mcd(s):
    return command_block('pliant bench mcd') + '\n\n' + mcd_table(bench_rows(s.pliant_output('bench', 'mcd')))


def klt(s):
    pairs = folder(s.options.klt_pairs, 'pairs of pictures with known motion (--klt-pairs)')
    shown = '320x240_win15_lev3_n500_'  # the other sizes and windows are like it
    rows = [(variant[len(shown):], metric, value) for variant, metric, value in
            bench_rows(s.pliant_output('bench', 'klt', '--pairs', pairs)) if variant.startswith(shown)]
    return command_block('pliant bench klt --pairs FOLDER') + '\n\n' + pivot(rows, 'motion', KLT_METRICS)


KLT_METRICS = ('err_median_px', 'err_p95_px', 'lost_fraction', 'kept_but_over_1px_fraction', 'hidden_but_kept_fraction')


DETECTION_CASES = (
    ('portraits_still', 'portrait, one picture'), ('portraits_film_start', 'portrait, film of 2 s: at the start'),
    ('portraits_film_after_2_s', 'portrait, film of 2 s: at the end'), ('portraits_five_points', 'portrait, from five points'),
    ('portraits_rolled', 'turned in the picture, each by another angle, film of 2 s: at the start'),
    ('returns_at_half_in_15_frames', 'gone for 1 s, back at half the size: within 15 frames'), ('returns_at_half', 'the same, within 1 s'),
    ('returns_at_twice_in_15_frames', 'gone for 1 s, back at twice the size: within 15 frames'), ('returns_at_twice', 'the same, within 1 s'))


def detection_tables(rows):
    values = {}
    for variant, metric, value in rows:
        values.setdefault(variant, {})[metric] = number(value)
    columns = ('cases', 'found_percent', 'right_percent', 'median_nme_percent', 'nme_percent_at_90', 'median_frame')
    parts = []
    cases = [[name] + [values[key].get(c, '') for c in columns] for key, name in DETECTION_CASES if key in values]
    if cases:
        parts.append(table(['start'] + ['cases', 'found %', 'right %', 'median NME %', 'at 90 %', 'frame'], cases))
    rest = [[variant.replace('_', ' '), metric.replace('_', ' '), value] for variant, metrics in values.items()
            for metric, value in metrics.items() if (metric not in columns or variant not in dict(DETECTION_CASES))]
    if rest:
        parts.append(table(['', 'measure', 'value'], rest, 2))
    return '\n\n'.join(parts)


def detection(s):
    data = folder(s.data, 'recorded faces (PLIANT_DATA)')
    text, words = [], ['bench', 'detection', '--model', s.face]
    portraits = os.path.join(data, 'portraits')
    if os.path.isdir(portraits):
        words += ['--portraits', portraits]
    if s.options.others:
        words += ['--others', folder(s.options.others, 'photographs without faces (--others)')]
    text += [command_block('pliant bench detection --model face.plm --portraits FOLDER --others FOLDER'), '',
             detection_tables(bench_rows(s.pliant_output(*words))), '']
    for kind, frames, name, _ in SEQUENCES:
        base, paths = franck_points(s, kind, 0, frames)
        film = franck_film(s, kind, base, frames)
        rows = bench_rows(s.pliant_output('bench', 'detection', '--model', s.face, '--film', film, '--truth', paths['truth']))
        text += ['Recorded face, %s, started at every 100th frame without points:' % name, '', detection_tables(rows), '']
    return '\n'.join(text).rstrip()


FAULT_COLUMNS = (('tracking_percent', 'tracking %'), ('wrong_frames', 'tracking and wrong, frames'), ('back_frames', 'back after'),
                 ('back_frames_worst', 'at most'), ('never_back', 'never'), ('most_of_bound_percent', 'most of its bound %'))


def faults(s):
    recorded_film = franck_film(s, 'mp4', folder(s.data and os.path.join(s.data, 'franck'), 'the recorded face'), 2400)
    runs = [('Recorded face', recorded_film, ()), ('Recorded face with profile S', recorded_film, ('--profile', 's'))]
    runs += [('Film %d of another person' % (k + 1), film, ()) for k, film in enumerate((s.options.face_films or '').split(',')) if film]
    found, clips = {}, []
    for name, film, words in runs:
        rows = bench_rows(s.pliant_output('bench', 'faults', '--model', s.face, '--film', film, '--count', '8', *words))
        clips.append('%s, %s clips' % (name, number(next(value for _, metric, value in rows if metric == 'clips'))))
        for fault, metric, value in rows:
            found.setdefault(fault, {}).setdefault(metric, []).append('-' if value == 'nan' else '%.3g' % float(value))
    return (command_block('pliant bench faults --model face.plm --film FILM --count 8') + '\n\n' + '; '.join(clips) + '.\n\n'
            + table(['fault'] + [title for _, title in FAULT_COLUMNS],
                    [[fault] + [' / '.join(values[key]) for key, _ in FAULT_COLUMNS] for fault, values in found.items()]))


# (name, words of fixtures/sheet/make.py, further words of `pliant bake`)
PRINTS = (('poster of `fixtures/sheet`, with which the constants were chosen', (), ()),
          ('another print: two columns of marks and a small map', ('--kind', 'page', '--seed', '2'), ()),
          ('another print: large plain shapes', ('--kind', 'shapes', '--seed', '3'), ()),
          ('photograph (`fixtures/astronaut`)', (), ('--texture', os.path.join(ROOT, 'fixtures', 'astronaut', 'astronaut.png'))))
PRINT_METRICS = ('found_percent', 'right_percent', 'rotation_within_10_percent', 'surface_error_percent', 'rotation_deg', 'frames')


def print_starts(s):
    text = [command_block('pliant bench print --model sheet.plm --count 10' + (' --others FOLDER' if s.options.others else ''))]
    words = ['--others', folder(s.options.others, 'photographs without the print (--others)')] if s.options.others else []
    for k, (name, make, bake) in enumerate(PRINTS):
        source, model = s.path('print%d' % k), s.path('print%d.plm' % k)
        run([sys.executable, os.path.join(ROOT, 'fixtures', 'sheet', 'make.py'), *make, source])
        run([s.pliant, 'bake', source, '--modes', '6', *bake, '-o', model])
        rows = bench_rows(s.pliant_output('bench', 'print', '--model', model, '--count', '10', *words))
        text += [name[0].upper() + name[1:] + ':', pivot(rows, 'surface', PRINT_METRICS)]
        text += ['%s: %s.' % (metric.replace('_', ' '), number(value)) for _, metric, value in rows if metric not in PRINT_METRICS]
    return '\n\n'.join(text)


SHEETS = (('paper', 'A', 1), ('occluded', 'B', 2), ('cloth', 'A', 1), ('cloth', 'B', 2), ('cloth', 'C', 7), ('paper', 'B', 2))  # scene, motion, print
SHEET_MODELS = (('12 modes', ('--modes', '12')), ('without springs', ('--modes', '12', '--stretch', '0')), ('6 modes', ('--modes', '6')))
SHEET_COLUMNS = (('frames', 'frames'), ('tracking', 'tracking'), ('degraded', 'degraded'), ('lost', 'lost'), ('wrong', 'tracking and wrong'),
                 ('error', 'error %'), ('error95', '95 %'), ('placed', 'with pose %'), ('px', 'px'), ('stretch', 'stretch %'),
                 ('floor', "shapes' floor %"), ('rigid', 'rigid sheet %'))


def sheet_film(s, scene, motion, print_):
    film = os.path.join(s.options.films or s.work, '%s-%s' % (scene, motion))
    if not os.path.exists(os.path.join(film, 'truth.txt')):
        run([tool('blender'), '--background', '--factory-startup', '--python-exit-code', '1', '--python',
             os.path.join(ROOT, 'tests', 'bench', 'sheet_film.py'), '--', '--out', film, '--scene', scene,
             '--motion', motion, '--print', str(print_)])
    video = s.path('%s-%s.y4m' % (scene, motion))
    run([tool('ffmpeg'), '-v', 'error', '-y', '-framerate', '30', '-i', os.path.join(film, 'frame%04d.png'), '-pix_fmt', 'gray',
         '-f', 'yuv4mpegpipe', '-strict', '-1', video])
    return film, video


def sheet(s):
    score_program = s.program('sheet_score')
    rows = []
    for scene, motion, print_ in SHEETS:
        film, video = sheet_film(s, scene, motion, print_)
        for label, words in SHEET_MODELS:
            model, start, track = s.path('sheet.plm'), s.path('start.json'), s.path('sheet.csv')
            run([s.pliant, 'bake', os.path.join(film, 'sheet.obj'), '--texture', os.path.join(film, 'print.png'), *words, '-o', model])
            run([s.pliant, 'fit', model, '--size', '320x240', '--points', os.path.join(film, 'points.csv'), '--focal', '420', '-o', start])
            text = run([s.pliant, 'track', model, '--frames', video, '--init', start, '--focal', '420', '--out', track], must=False)
            found = pairs_of(run([score_program, model, os.path.join(film, 'truth.txt'), track]).stdout)
            time_ms = pairs_of(text.stdout + text.stderr).get('median_ms', '')
            rows.append(['%s %s' % (scene, motion), label] + [number('%.3g' % float(found[key])) for key, _ in SHEET_COLUMNS] + [time_ms])
    return (command_block('blender ... --python tests/bench/sheet_film.py -- --scene SCENE --motion MOTION --print SEED --out FILM',
                          'pliant bake FILM/sheet.obj --texture FILM/print.png --modes N -o sheet.plm',
                          'pliant fit sheet.plm --size 320x240 --points FILM/points.csv --focal 420 -o start.json',
                          'pliant track sheet.plm --frames film.y4m --init start.json --focal 420 --out track.csv',
                          'sheet_score sheet.plm FILM/truth.txt track.csv') + '\n\n'
            + table(['film', 'model'] + [name for _, name in SHEET_COLUMNS] + ['ms a frame'], rows, 2))


def fit(s):
    problems = folder(s.options.fit_problems, 'fitting problems with their optima (--fit-problems)')
    rows = bench_rows(s.pliant_output('bench', 'fit', '--problems', problems))
    keep = ('ms_median', 'ms_worst_problem', 'iterations_median', 'cost_above_optimum_median', 'cost_above_optimum_worst')
    return command_block('pliant bench fit --problems FOLDER') + '\n\n' + pivot(rows, 'problem and method', keep)


def memory(s):
    columns, names = {}, []
    for profile in ('l', 'm', 's'):  # the largest first: it has every row
        result = run([s.pliant, 'plan', s.face, '--profile', profile], must=False)
        if result.returncode != 0:
            continue
        for line in result.stdout.splitlines():
            if line.startswith('a frame'):
                break
            found = re.match(r'^(?:  )?(.+?)\s{2,}(\d+)$', line)
            if found is None:
                continue
            name = found.group(1)
            if name not in names:
                names.append(name)
            columns.setdefault(profile, {})[name] = found.group(2)
    if not columns:
        raise Missing('`pliant plan`')
    columns = {p: columns[p] for p in ('s', 'm', 'l') if p in columns}
    rows = [[n] + [columns[p].get(n, '') for p in columns] for n in names]
    return command_block('pliant plan face.plm --profile s') + '\n\n' + \
        table(['bytes'] + ['profile %s' % p.upper() for p in columns], rows)


def work(s):
    parts = []
    for profile in ('s', 'l'):
        lines = s.pliant_output('plan', s.face, '--profile', profile).splitlines()
        kinds = []  # of frames: name and rows
        for line in lines:
            row = re.split(r'\s{2,}', line.strip())
            if line.startswith('a frame') and 'usually' in line:
                kinds.append((row[0], []))
            elif kinds and len(row) == 4 and row[1].isdigit():
                kinds[-1][1].append(row)
        for kind, rows in kinds:
            parts += ['Profile %s, %s:' % (profile.upper(), 'a frame with a track' if kind == 'a frame' else kind), '',
                      table(['passes', 'usually', 'at most', 'instructions each'], rows), '']
    return command_block('pliant plan face.plm --profile s') + '\n\n' + '\n'.join(parts).rstrip()


def sizes(s):
    out = run(['sh', os.path.join(ROOT, 'tests', 'target', 'sizes.sh')], must=False).stdout
    lines = out.splitlines()
    if sum(line.startswith('| ') for line in lines) < 2:
        raise Missing('built targets (sh tests/run.sh --targets)')
    return command_block('sh tests/run.sh --targets', 'sh tests/target/sizes.sh') + '\n\n' + \
        '\n'.join(l for l in lines if l.startswith('|')) + '\n' + ''.join('\n%s.' % l.rstrip('.') for l in lines if l and not l.startswith('|'))


# name -> (function, only with --long)
SECTIONS = {
    'machine': (machine, False),
    'demo': (demo, False),
    'recorded': (recorded, False),
    'recorded-variants': (recorded_variants, False),
    'recorded-eyes': (recorded_eyes, False),
    'detection': (detection, False),
    'faults': (faults, False),
    'print': (print_starts, False),
    'track': (bench('track', '--model', 'FACE',
                    keep=('median_ms', 'worst_ms', 'landmark_px', 'rotation_deg', 'patches_found', 'vertices', 'arena_bytes')), False),
    'cost': (bench('cost', '--model', 'FACE', keep=('median_ms', 'worst_ms', 'landmark_px', 'rotation_deg', 'arena_bytes')), False),
    'cues': (bench('cues', '--model', 'FACE', keep=('median_ms', 'landmark_px', 'rotation_deg', 'patches_found')), False),
    'drift': (bench('drift', '--model', 'FACE'), False),
    'occlusion': (bench('occlusion', '--model', 'FACE', keep=('mean_px', 'fraction_over_3px')), False),
    'mcd': (mcd, False),
    'fit': (fit, False),
    'sheet': (sheet, True),
    'klt': (klt, False),
    'fields': (bench('fields', '--model', 'FACE'), False),
    'mesh-table': (mesh_table, False),
    'mesh-operations': (mesh_operations, False),
    'figure9': (figure9, False),
    'figure9-recorded': (figure9_recorded, True),
    'memory': (memory, False),
    'work': (work, False),
    'sizes': (sizes, False),
}


def replace_block(text, name, content):
    begin, end = '<!-- measured: %s -->' % name, '<!-- end of %s -->' % name
    first, last = text.find(begin), text.find(end)
    if first < 0 or last < first:
        raise SystemExit('evaluate.py: docs/evaluation.md has no place for %s' % name)
    return text[:first + len(begin)] + '\n\n' + wrapped(content.strip('\n')) + '\n\n' + text[last:]


def block(text, name):
    found = re.search('<!-- measured: %s -->\n*(.*?)\n*<!-- end of %s -->' % (name, name), text, re.S)
    return found.group(1) if found else ''


def revision():
    result = run(['git', '-C', ROOT, 'rev-parse', '--short', 'HEAD'], must=False)
    return result.stdout.strip() if result.returncode == 0 else ''


def parse(words):
    parser = argparse.ArgumentParser(usage=__doc__.split('usage: ')[1].split('\n\nPython')[0])
    parser.add_argument('--only')
    parser.add_argument('--long', action='store_true')
    parser.add_argument('--build', default='build/release')
    parser.add_argument('--data', default=os.environ.get('PLIANT_DATA'))
    parser.add_argument('--others')
    parser.add_argument('--face-films')
    parser.add_argument('--klt-pairs')
    parser.add_argument('--films')
    parser.add_argument('--fit-problems')
    parser.add_argument('--list', action='store_true')
    return parser.parse_args(words)


def main(words):
    options = parse(words)
    if options.list:
        print('\n'.join(SECTIONS))
        return 0
    wanted = options.only.split(',') if options.only else [n for n, (_, is_long) in SECTIONS.items() if options.long or not is_long]
    unknown = [name for name in wanted if name not in SECTIONS]
    if unknown:
        sys.exit('evaluate.py: no such section: %s' % ', '.join(unknown))
    os.environ['LC_ALL'] = 'C'
    failed = False
    stamp = 'Measured %s%s.' % (time.strftime('%Y-%m-%d', time.gmtime()), ', revision ' + revision() if revision() else '')
    with tempfile.TemporaryDirectory() as work:
        s = Setup(options, work)
        if not os.path.exists(s.pliant):
            sys.exit('evaluate.py: no %s; build it first: cmake --preset release && cmake --build --preset release' % s.pliant)
        run([s.pliant, 'bake', os.path.join(ROOT, 'fixtures', 'face'), '-o', s.face])
        for k, name in enumerate(wanted):
            print('%d of %d: %s' % (k + 1, len(wanted), name), file=sys.stderr, flush=True)
            began = time.time()
            with open(DOCUMENT) as file:
                text = file.read()
            try:
                content = SECTIONS[name][0](s) + ('\n\n' + stamp if name != 'machine' else '')
            except Missing as reason:
                print('  not measured: %s' % reason, file=sys.stderr)
                if block(text, name) and not block(text, name).startswith('Not measured'):
                    continue
                content = 'Not measured: %s is missing.' % str(reason)
            except (ValueError, KeyError, StopIteration, AttributeError, IndexError) as fault:
                print('  failed, kept as it is: %s: %s' % (type(fault).__name__, fault), file=sys.stderr)
                failed = True
                continue
            with open(DOCUMENT, 'w') as file:
                file.write(replace_block(text, name, content))
            print('  %.0f s' % (time.time() - began), file=sys.stderr)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
