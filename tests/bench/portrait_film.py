"""A photograph of a face that moves in space: the photograph on a smooth surface of the face's depth, before a camera with known
pose, so that the true landmarks of every frame are the annotated ones, moved. Used by portrait_films.py."""
import csv
import math
import os
import subprocess
import tempfile

import cv2
import numpy

WIDTH, HEIGHT, FOCAL = 320, 240, 448.0  # px
EYES_MM = 90.0         # between the outer corners of the eyes, by which a portrait gets its size
BACKGROUND_MM = -35.0  # depth of what is no face
SPREAD_PX = 6.0        # deviation by which depths of vertices spread over the photograph
STEPS = 6              # of the inversion of a frame's warp; it then errs by less than 0.05 px up to 30 degrees
EDGE_PX = 12.0         # over which the photograph's border turns into the background


def held_out(name):
    """What training never uses (platform/host/learn/photographs.hpp)."""
    h = 2166136261
    for c in name.encode():
        h = ((h ^ c) * 16777619) & 0xffffffff
    return h % 3 == 0


def read_landmarks(folder):
    people = {}
    with open(os.path.join(folder, 'landmarks.csv')) as lines:
        for row in csv.DictReader(lines):
            if row['landmark'].startswith('ibug') and held_out(row['name']):
                people.setdefault(row['name'], {})[row['landmark']] = (float(row['x']), float(row['y']))
    return people


def model_surface(pliant, face):
    """Vertices of the model's face at rest and its landmarks, mm: x to the right, y down, z towards the camera."""
    with tempfile.TemporaryDirectory() as scratch:
        mesh, row, truth, film = (os.path.join(scratch, n) for n in ('face.obj', 'q.csv', 'truth.csv', 'film.y4m'))
        subprocess.run([pliant, 'mesh', face, '--criterion', 'none', '-o', mesh], check=True, stdout=subprocess.DEVNULL)
        with open(mesh) as lines:
            vertices = numpy.array([[float(v) for v in line.split()[1:4]] for line in lines if line.startswith('v ')])
        with open(row, 'w') as out:
            out.write('frame,qw,qx,qy,qz,tx,ty,tz\n0,1,0,0,0,0,0,60000\n')  # so far away that depth plays no part
        subprocess.run([pliant, 'render', face, '--params', row, '--size', '%dx%d' % (WIDTH, HEIGHT), '--focal', '44800', '-o', film,
                        '--truth-points', truth], check=True, stdout=subprocess.DEVNULL)
        with open(truth) as lines:
            landmarks = {r['landmark']: ((float(r['x']) - WIDTH / 2) / 44800 * 60000, (float(r['y']) - HEIGHT / 2) / 44800 * 60000)
                         for r in csv.DictReader(lines)}
    return vertices * (1, -1, 1), landmarks


def similarity(sources, targets):
    """The complex a and b for which a * source + b is nearest to the targets."""
    s, t = (numpy.array([complex(*p) for p in points]) for points in (sources, targets))
    a = numpy.vdot(s - s.mean(), t - t.mean()) / numpy.vdot(s - s.mean(), s - s.mean())
    return a, t.mean() - a * s.mean()


def rotation(yaw, pitch, roll):
    """Of a face whose x points right, y down and z at the camera; degrees, to the right, down and clockwise in the picture."""
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (yaw, pitch, roll))
    return (numpy.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]]) @ numpy.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @
            numpy.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]]))


class Portrait:
    def __init__(self, folder, name, landmarks, surface):
        self.name = name
        self.picture = cv2.imread(os.path.join(folder, name + '.jpg'), cv2.IMREAD_GRAYSCALE).astype(numpy.float32)
        self.names = sorted(landmarks)
        self.points = numpy.array([landmarks[n] for n in self.names], numpy.float32)
        vertices, rest = surface
        a, b = similarity([rest[n] for n in self.names], self.points)
        self.middle = numpy.array([b.real, b.imag], numpy.float32)
        eyes = abs(complex(*landmarks['ibug45']) - complex(*landmarks['ibug36']))
        self.mm = EYES_MM / eyes  # of a pixel
        self.depth = self.depth_map(vertices, a, b)
        self.depths = cv2.remap(self.depth, self.points[:, None, 0], self.points[:, None, 1], cv2.INTER_LINEAR).ravel()
        h, w = self.picture.shape
        y, x = numpy.mgrid[0:h, 0:w].astype(numpy.float32)
        self.cover = numpy.clip(numpy.minimum(numpy.minimum(x, w - 1 - x), numpy.minimum(y, h - 1 - y)) / EDGE_PX, 0, 1)

    def depth_map(self, vertices, a, b):
        h, w = self.picture.shape
        weight = numpy.full((h, w), 1e-4, numpy.float32)
        total = weight * BACKGROUND_MM
        for x, y, z in vertices:
            p = a * complex(x, y) + b
            column, row = int(round(p.real)), int(round(p.imag))
            if 0 <= column < w and 0 <= row < h and z > BACKGROUND_MM:
                weight[row, column] += 1
                total[row, column] += z
        smooth = [cv2.GaussianBlur(m, (0, 0), SPREAD_PX) for m in (total, weight)]
        return cv2.GaussianBlur(smooth[0] / smooth[1], (0, 0), SPREAD_PX)

    def project(self, x, y, depth, pose):
        """Where places of the photograph are in the frame. pose: yaw, pitch, roll (degrees); x, y (px); distance of the eyes (px)."""
        yaw, pitch, roll, cx, cy, eyes = pose
        distance = FOCAL * EYES_MM / eyes
        m = rotation(yaw, pitch, roll)
        px, py = (x - self.middle[0]) * self.mm, (y - self.middle[1]) * self.mm
        ahead = distance - (m[2, 0] * px + m[2, 1] * py + m[2, 2] * depth)
        shift = (cx - WIDTH / 2) / FOCAL * distance, (cy - HEIGHT / 2) / FOCAL * distance
        return [WIDTH / 2 * (1 - i) + HEIGHT / 2 * i +
                FOCAL * (m[i, 0] * px + m[i, 1] * py + m[i, 2] * depth + shift[i]) / ahead for i in (0, 1)]

    def frame(self, pose, background):
        """The frame (grey levels, float) and the true landmarks, px."""
        v, u = numpy.mgrid[0:HEIGHT, 0:WIDTH].astype(numpy.float32)
        flat = (rotation(*pose[:3])[:2, :2] * (FOCAL * self.mm / (FOCAL * EYES_MM / pose[5])))
        back = numpy.linalg.inv(flat).astype(numpy.float32)
        x, y = self.middle[0] + back[0, 0] * (u - pose[3]) + back[0, 1] * (v - pose[4]), \
            self.middle[1] + back[1, 0] * (u - pose[3]) + back[1, 1] * (v - pose[4])
        for _ in range(STEPS):
            depth = cv2.remap(self.depth, x.astype(numpy.float32), y.astype(numpy.float32), cv2.INTER_LINEAR,
                              borderMode=cv2.BORDER_REPLICATE)
            p, q = self.project(x, y, depth, pose)
            x, y = x + back[0, 0] * (u - p) + back[0, 1] * (v - q), y + back[1, 0] * (u - p) + back[1, 1] * (v - q)
        x, y = x.astype(numpy.float32), y.astype(numpy.float32)
        shown = cv2.remap(self.picture, x, y, cv2.INTER_AREA if flat[0, 0] < 1 else cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        cover = cv2.remap(self.cover, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        points = numpy.stack(self.project(self.points[:, 0], self.points[:, 1], self.depths, pose), 1)
        return cover * shown + (1 - cover) * background, points
