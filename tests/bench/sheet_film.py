"""Films of a printed sheet with known truth, ray-traced by Blender.

usage: blender --background --factory-startup --python-exit-code 1 --python tests/bench/sheet_film.py --
           --out FOLDER [--scene paper|occluded|cloth] [--motion A|B|C] [--print PICTURE|SEED] [--frames N] [--samples N]
  --out FOLDER      gets frame%04d.png, truth.txt, sheet.obj, print.png and points.csv
  --scene paper     a sheet that does not stretch bends into cones of changing direction and cross-section, and turns
  --scene occluded  the same, with a hand that moves across and hides up to 30 % of the sheet
  --scene cloth     a cloth that stretches and folds between two hands (Blender's cloth)
  --motion A|B|C    three different motions: A to choose constants on, B and C to report (A)
  --print           the picture on the sheet, or the seed of one that is drawn (1)
  --frames N        frames of the film, at 30 a second (300)
  --samples N       rays a pixel (16)

truth.txt: `camera W H f cx cy`, px; `rest U V X Y`, a line a vertex: (u,v), and its place in the flat sheet, mm; then
`frame K` and a line `X Y Z` a vertex, in the camera's axes (x right, y down, z away from the camera), mm.
points.csv: what `pliant fit --points` needs to start in frame 0.
"""
import argparse
import csv
import math
import os
import sys

import bpy
import numpy

WIDTH, HEIGHT = 320, 240  # px
SHEET = (1.0, 0.7)        # Blender's units
MM = 210.0                # of a unit
CELLS = (40, 28)          # of the simulation
TRUTH_STEP = 2            # every second vertex is written
FOCAL = 420.0             # px
DISTANCE = 1.9            # units from the camera to the middle of the sheet
SETTLE = 20               # frames before the film


def options():
    words = sys.argv[sys.argv.index('--') + 1:] if '--' in sys.argv else []
    parser = argparse.ArgumentParser()
    parser.add_argument('--out', required=True)
    parser.add_argument('--scene', choices=('paper', 'occluded', 'cloth'), default='paper')
    parser.add_argument('--motion', choices=('A', 'B', 'C'), default='A')
    parser.add_argument('--print', dest='print_', default='1')
    parser.add_argument('--frames', type=int, default=300)
    parser.add_argument('--samples', type=int, default=16)
    return parser.parse_args(words)


# --- The print ---

def draw_print(seed, size=(512, 358)):
    """Discs, bars and lines of writing, large and small, in grey."""
    random = numpy.random.RandomState(seed)
    width, height = size
    picture = numpy.full((height, width), 0.82)
    y, x = numpy.mgrid[0:height, 0:width].astype(float)
    for _ in range(70):
        cx, cy, radius = random.uniform(0, width), random.uniform(0, height), random.uniform(5, 34)
        angle, flat = random.uniform(0, math.pi), random.uniform(0.3, 1)
        a = (x - cx) * math.cos(angle) + (y - cy) * math.sin(angle)
        b = (y - cy) * math.cos(angle) - (x - cx) * math.sin(angle)
        if random.rand() < 0.5:
            inside = a * a + (b / flat) ** 2 < radius * radius
        else:
            inside = (abs(a) < radius) & (abs(b) < radius * flat)
        picture[inside] = random.uniform(0.05, 0.95)
    for _ in range(26):
        left, top = random.randint(0, width - 60), random.randint(0, height - 12)
        for k in range(random.randint(3, 9)):
            letter = random.rand(5, 4) < 0.5
            block = numpy.kron(letter, numpy.ones((2, 2)))
            at = left + 10 * k
            if at + 8 <= width and top + 10 <= height:
                picture[top:top + 10, at:at + 8][block > 0] = 0.08
    return picture


def save_grey(picture, path):
    height, width = picture.shape
    image = bpy.data.images.new(os.path.basename(path), width, height)
    pixels = numpy.ones((height, width, 4))
    pixels[..., :3] = picture[::-1, :, None]  # Blender's rows begin at the bottom
    image.pixels = pixels.ravel().tolist()
    image.filepath_raw, image.file_format = path, 'PNG'
    image.save()
    return image


def material(name, colour, image=None, rough=0.6):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = nodes['Principled BSDF']
    shader.inputs['Roughness'].default_value = rough
    shader.inputs['Specular'].default_value = 0.2
    shader.inputs['Base Color'].default_value = (*colour, 1)
    if image is not None:
        texture = nodes.new('ShaderNodeTexImage')
        texture.image = image
        links.new(texture.outputs['Color'], shader.inputs['Base Color'])
    return made


# --- Motion: t runs from 0 to 1 in the film; everything is at rest at 0 ---

def ease(t):
    return 0 if t <= 0 else 1 if t >= 1 else t * t * (3 - 2 * t)


def bump(t, first, last):
    """0 outside, 1 in the middle."""
    return 0 if t <= first or t >= last else 0.5 - 0.5 * math.cos(2 * math.pi * (t - first) / (last - first))


def turn_and_shift(t, which):
    """Turn about x, y, z (rad) and shift (units)."""
    d = math.radians
    if which == 'A':
        turn = (d(18) * math.sin(2 * math.pi * t) * ease(5 * t),
                d(45) * (bump(t, 0.10, 0.52) - bump(t, 0.55, 0.95)), d(10) * bump(t, 0.3, 0.9))
        shift = (0.05 * math.sin(3 * math.pi * t), 0.03 * math.sin(2 * math.pi * t), 0.12 * bump(t, 0.1, 0.9))
    elif which == 'C':
        turn = (-d(22) * bump(t, 0.0, 0.45) + d(20) * bump(t, 0.6, 1.0),
                d(40) * (bump(t, 0.0, 0.3) - bump(t, 0.3, 0.6) + bump(t, 0.65, 1.0)), d(16) * bump(t, 0.15, 0.75))
        shift = (0.06 * math.sin(1.7 * math.pi * t), 0.04 * math.sin(2.6 * math.pi * t), 0.1 * bump(t, 0.3, 1.0))
    else:
        turn = (d(25) * (bump(t, 0.3, 0.7) - bump(t, 0.7, 1.0)),
                d(45) * (-bump(t, 0.05, 0.45) + bump(t, 0.5, 0.9)), -d(14) * bump(t, 0.1, 0.6))
        shift = (-0.05 * math.sin(2.4 * math.pi * t), 0.04 * math.sin(1.6 * math.pi * t), -0.1 * bump(t, 0.2, 0.8))
    r = rotation(2, turn[2]) @ rotation(1, turn[1]) @ rotation(0, turn[0])
    return r, numpy.array(shift)


def bending(t, which):
    """Direction of the bend (rad), distance of the cone's apex (units), and curvature along the bend: its mean, slope and wave
    (1/unit)."""
    d = math.radians
    if which == 'A':
        return (d(35) * math.sin(2 * math.pi * 1.3 * t), 1.2 + 6 * (0.5 + 0.5 * math.cos(2 * math.pi * 1.7 * t)),
                2.0 * (bump(t, 0.02, 0.35) - bump(t, 0.36, 0.66) + bump(t, 0.66, 1.0)),
                1.2 * (bump(t, 0.2, 0.6) - bump(t, 0.6, 1.0)), 1.0 * bump(t, 0.45, 0.85))
    return (-d(45) * math.sin(2 * math.pi * 0.9 * t) + d(90) * ease((t - 0.62) * 8), 1.5 + 5 * (0.5 - 0.5 * math.cos(2 * math.pi * 1.1 * t)),
            2.0 * (-bump(t, 0.03, 0.30) + bump(t, 0.30, 0.62) - 0.9 * bump(t, 0.68, 1.0)),
            -1.4 * bump(t, 0.1, 0.5) + 1.2 * bump(t, 0.5, 0.64), -1.2 * bump(t, 0.3, 0.6))


def rotation(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    m = numpy.eye(3)
    m[i, i] = m[j, j] = c
    m[i, j], m[j, i] = -s, s
    return m


def bend(flat, direction, apex, mean, slope, wave):
    """Rolls the flat sheet onto a cone of any cross-section. Lengths on the sheet stay the same: the cone's generators g are a
    curve on the unit sphere that is run through at unit speed in the angle around the apex."""
    half = 0.75 / apex  # rad, beyond the sheet
    steps = 600
    d = half / steps

    def generators(sign):
        g, t, n = numpy.eye(3)[1], sign * numpy.eye(3)[0], numpy.eye(3)[2]
        found = [g]
        for k in range(steps):
            s = sign * (k + 0.5) * d * apex
            curvature = apex * (mean + slope * s / 0.5 + wave * math.cos(3 * math.pi * s))
            speed = math.hypot(1, curvature)
            axis = (n + curvature * g) / speed  # g' = t, t' = -g + curvature n, n' = -curvature t
            c, q = math.cos(speed * d), math.sin(speed * d)

            def turned(x, sense=1.0):
                return c * x + q * sense * numpy.cross(axis, x) + (1 - c) * axis.dot(x) * axis

            # (g, t, n) turns about the axis with g x t = -n for sign 1.
            sense = 1.0 if numpy.cross(axis, g).dot(t) > 0 else -1.0
            g, t, n = turned(g, sense), turned(t, sense), turned(n, sense)
            found.append(g)
        return found

    curve = numpy.array(generators(-1)[:0:-1] + generators(1))
    c, q = math.cos(direction), math.sin(direction)
    s, w = c * flat[:, 0] + q * flat[:, 1], c * flat[:, 1] - q * flat[:, 0]
    radius, angle = numpy.hypot(s, w + apex), numpy.arctan2(s, w + apex)
    at = numpy.linspace(-half, half, 2 * steps + 1)
    p = radius[:, None] * numpy.stack([numpy.interp(angle, at, curve[:, k]) for k in range(3)], axis=1)
    p[:, 1] -= apex
    return numpy.stack([c * p[:, 0] - q * p[:, 1], q * p[:, 0] + c * p[:, 1], p[:, 2]], axis=1)


def paper_place(flat, t, which):
    r, shift = turn_and_shift(t, which)
    return bend(flat, *bending(t, which)) @ r.T + shift


def cloth_hand(side, point, t, which):
    """Where a held vertex of the cloth goes: the hands pull beyond its length, then come near each other."""
    r, shift = turn_and_shift(t, which)
    half = SHEET[0] / 2
    if which == 'C':  # one hand pulls, twice, the other comes near and lifts
        pull = 0.3 * (bump(t, 0.1, 0.4) + bump(t, 0.6, 0.9)) if side < 0 else -0.7 * bump(t, 0.2, 0.85)
        lift = 0 if side < 0 else 0.15 * bump(t, 0.2, 0.85)
        return r @ numpy.array([point[0] + side * half * pull, point[1] + lift, lift]) + shift
    reach = half * (1 + 0.22 * bump(t, 0.05, 0.35) - 0.62 * bump(t, 0.42, 0.95))
    return r @ numpy.array([point[0] + side * (reach - half), point[1], 0]) + shift


# --- The scene ---

def make_sheet(scene, which, frames, image):
    columns, rows = CELLS[0] + 1, CELLS[1] + 1
    vertices, uv = [], []
    for j in range(rows):
        for i in range(columns):
            u, v = i / CELLS[0], j / CELLS[1]
            vertices.append(((u - 0.5) * SHEET[0], (0.5 - v) * SHEET[1], 0))
            uv.append((u, v))
    faces = [(j * columns + i, (j + 1) * columns + i, (j + 1) * columns + i + 1, j * columns + i + 1)
             for j in range(CELLS[1]) for i in range(CELLS[0])]
    mesh = bpy.data.meshes.new('sheet')
    mesh.from_pydata(vertices, [], faces)
    layer = mesh.uv_layers.new(name='uv')
    for loop in mesh.loops:
        u, v = uv[loop.vertex_index]
        layer.data[loop.index].uv = (u, 1 - v)
    sheet = bpy.data.objects.new('sheet', mesh)
    bpy.context.collection.objects.link(sheet)
    mesh.materials.append(material('paper', (0.8, 0.8, 0.8), image))
    for polygon in mesh.polygons:
        polygon.use_smooth = True

    # Paper moves by shape keys alone; of cloth they move what the hands hold.
    rest = numpy.array(vertices)
    held = [k for k, (u, v) in enumerate(uv) if (u < 1.5 / CELLS[0] or u > 1 - 1.5 / CELLS[0]) and v < 0.2]
    sheet.shape_key_add(name='rest')
    for frame in range(frames):
        key = sheet.shape_key_add(name='k%d' % frame)
        if scene == 'cloth':
            for k in held:
                key.data[k].co = cloth_hand(-1 if uv[k][0] < 0.5 else 1, rest[k], frame / 299.0, which)
        else:
            key.data.foreach_set('co', paper_place(rest, frame / 299.0, which).ravel())
        for at, value in ((frame - 1, 0), (frame, 1), (frame + 1, 0)):
            key.value = value
            key.keyframe_insert('value', frame=SETTLE + at)
    for curve in sheet.data.shape_keys.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = 'LINEAR'
    if scene == 'cloth':
        add_cloth(sheet, held, frames)
    return sheet, vertices, uv


def add_cloth(sheet, held, frames):
    sheet.vertex_groups.new(name='held').add(held, 1.0, 'REPLACE')
    cloth = sheet.modifiers.new('cloth', 'CLOTH')
    s = cloth.settings
    s.quality = 12
    s.vertex_group_mass = 'held'
    s.mass = 0.15
    s.air_damping = 2
    s.tension_stiffness = s.compression_stiffness = 12
    s.shear_stiffness = 4
    s.bending_stiffness = 0.4
    s.effector_weights.gravity = 0.6
    cloth.collision_settings.use_collision = False
    cloth.collision_settings.use_self_collision = True
    cloth.collision_settings.self_distance_min = 0.2 / CELLS[0]  # well below a cell: else neighbours push each other away
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, SETTLE + frames + 1


def make_hand():
    """Four fingers, a thumb and a palm."""
    skin = material('skin', (0.55, 0.34, 0.25), rough=0.5)
    parts = []

    def ball(place, size, turn=0.0):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=place)
        part = bpy.context.object
        part.scale, part.rotation_euler = size, (0, 0, turn)
        parts.append(part)

    ball((0, -0.24, 0), (0.17, 0.20, 0.04))
    for k, reach in enumerate((0.26, 0.32, 0.30, 0.22)):
        x = -0.13 + 0.085 * k
        for j in range(3):
            ball((x + 0.02 * (k - 1.5) * j, -0.1 + reach * (j + 0.5) / 3, 0.01 * j), (0.042, reach / 3.4, 0.036))
    ball((0.22, -0.18, 0), (0.05, 0.13, 0.04), -0.6)
    ball((0, -0.62, 0), (0.12, 0.3, 0.05))
    hand = bpy.data.objects.new('hand', None)
    bpy.context.collection.objects.link(hand)
    for part in parts:
        part.data.materials.append(skin)
        part.parent = hand
        for polygon in part.data.polygons:
            polygon.use_smooth = True
    return hand


def move_hand(hand, frames):
    for frame in range(frames):
        t = frame / 299.0
        hand.location = (-1.15 + 2.3 * t, -0.05 + 0.05 * math.sin(9 * t), 0.34)
        hand.rotation_euler = (0, 0, 0.5 - 1.0 * t)
        hand.keyframe_insert('location', frame=SETTLE + frame)
        hand.keyframe_insert('rotation_euler', frame=SETTLE + frame)


def light(place, size, power):
    bpy.ops.object.light_add(type='AREA', location=place)
    lamp = bpy.context.object
    lamp.data.size, lamp.data.energy = size, power
    to = -numpy.array(place)
    lamp.rotation_euler = (math.acos(-to[2] / numpy.linalg.norm(to)), 0, math.atan2(to[1], to[0]) + math.pi / 2)


def set_up(scene_name, samples):
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene.render.engine = 'CYCLES'
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 2
    scene.render.threads_mode, scene.render.threads = 'FIXED', 1
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.4
    scene.cycles.motion_blur_position = 'CENTER'
    scene.render.image_settings.color_mode = 'BW'
    scene.render.fps = 30
    scene.view_settings.view_transform = 'Standard'
    scene.world = bpy.data.worlds.new('world')
    scene.world.use_nodes = True
    scene.world.node_tree.nodes['Background'].inputs[0].default_value = (0.3, 0.3, 0.3, 1)
    scene.gravity = (0, -9.81, 0)  # y is up in the camera's view
    camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location = (0, 0, DISTANCE)
    camera.data.sensor_width = 36
    camera.data.lens = FOCAL * 36 / WIDTH
    light((1.2, 1.4, 2.0), 0.8, 42)
    light((-1.6, 0.4, 1.4), 0.5, 18)
    bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, -1.2))
    wall = bpy.context.object
    look = material('wall', (0.3, 0.3, 0.3))
    noise = look.node_tree.nodes.new('ShaderNodeTexNoise')
    noise.inputs['Scale'].default_value = 3
    look.node_tree.links.new(noise.outputs['Fac'], look.node_tree.nodes['Principled BSDF'].inputs['Base Color'])
    wall.data.materials.append(look)
    return scene


# --- Truth ---

def in_camera(place):
    """mm, x right, y down, z away."""
    return numpy.stack([place[:, 0], -place[:, 1], DISTANCE - place[:, 2]], axis=1) * MM


def write_obj(path, vertices, uv):
    columns, rows = CELLS[0] // TRUTH_STEP + 1, CELLS[1] // TRUTH_STEP + 1
    with open(path, 'w') as file:
        for j in range(rows):
            for i in range(columns):
                k = j * TRUTH_STEP * (CELLS[0] + 1) + i * TRUTH_STEP
                x, y, z = vertices[k]
                file.write('v %.4f %.4f %.4f\nvt %.6f %.6f\n' % (x * MM, y * MM, z * MM, uv[k][0], 1 - uv[k][1]))
        for j in range(rows - 1):
            for i in range(columns - 1):
                corners = [j * columns + i, (j + 1) * columns + i, (j + 1) * columns + i + 1, j * columns + i + 1]
                file.write('f ' + ' '.join('%d/%d' % (c + 1, c + 1) for c in corners) + '\n')


def main():
    args = options()
    os.makedirs(args.out, exist_ok=True)
    scene = set_up(args.scene, args.samples)
    if args.print_.isdigit():
        image = save_grey(draw_print(int(args.print_)), os.path.join(args.out, 'print.png'))
    else:
        image = bpy.data.images.load(os.path.abspath(args.print_))
    sheet, vertices, uv = make_sheet(args.scene, args.motion, args.frames, image)
    if args.scene == 'occluded':
        move_hand(make_hand(), args.frames)
    kept = [j * (CELLS[0] + 1) + i for j in range(0, CELLS[1] + 1, TRUTH_STEP) for i in range(0, CELLS[0] + 1, TRUTH_STEP)]
    write_obj(os.path.join(args.out, 'sheet.obj'), vertices, uv)
    truth = open(os.path.join(args.out, 'truth.txt'), 'w')
    cx, cy = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
    truth.write('camera %d %d %.6f %.6f %.6f\n' % (WIDTH, HEIGHT, FOCAL, cx, cy))
    for k in kept:
        truth.write('rest %.6f %.6f %.4f %.4f\n' % (*uv[k], vertices[k][0] * MM, vertices[k][1] * MM))
    scene.frame_start, scene.frame_end = 1, SETTLE + args.frames + 1
    for frame in range(1, SETTLE):
        scene.frame_set(frame)
    for frame in range(args.frames):
        scene.frame_set(SETTLE + frame)
        seen = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        place = numpy.empty(3 * len(seen.vertices))
        seen.vertices.foreach_get('co', place)
        place = in_camera(place.reshape(-1, 3))[kept]
        truth.write('frame %d\n' % frame + ''.join('%.3f %.3f %.3f\n' % tuple(p) for p in place))
        if frame == 0:
            with open(os.path.join(args.out, 'points.csv'), 'w', newline='') as file:
                table = csv.writer(file)
                table.writerow(('landmark', 'x', 'y', 'u', 'v'))
                for n, k in enumerate(kept):
                    x, y, z = place[n]
                    table.writerow(('p%03d' % n, '%.4f' % (FOCAL * x / z + cx), '%.4f' % (FOCAL * y / z + cy),
                                    '%.6f' % uv[k][0], '%.6f' % uv[k][1]))
        if args.samples:
            scene.render.filepath = os.path.join(args.out, 'frame%04d.png' % frame)
            bpy.ops.render.render(write_still=True)
    truth.close()


main()
