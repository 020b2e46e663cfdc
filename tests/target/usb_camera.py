#!/usr/bin/env python3
"""A USB camera without hardware: QEMU's usb-redir device connects to it and sees a USB Video Class camera that plays a file.

usage: usb_camera.py SOCKET VIDEO.y4m FRAMES_PER_SECOND [UNPLUG_AFTER]

The video (luma first: mono or planar YUV) is repeated for ever, from its first frame whenever streaming starts; with
UNPLUG_AFTER the plug is pulled after so many frames. The picture goes out as YUY2 over a bulk endpoint, grey.
"""
import os
import socket
import struct
import sys
import time

# The packet types of the usbredir protocol that a camera needs.
HELLO, CONNECT, INTERFACES, ENDPOINTS = 0, 1, 4, 5
SET_CONFIGURATION, GET_CONFIGURATION, CONFIGURATION = 6, 7, 8
SET_ALTERNATE, GET_ALTERNATE, ALTERNATE = 9, 10, 11
CONTROL, BULK = 100, 101
CAN_VERSION, CAN_PACKET_SIZE, CAN_LONG_IDS, CAN_LONG_BULK = 1 << 1, 1 << 4, 1 << 5, 1 << 6
STALL = 4

VENDOR, PRODUCT = 0x1D6B, 0x0102  # the Linux Foundation's, as its own gadget webcam uses
STREAM_ENDPOINT = 0x81
PAYLOAD_BYTES = 16384  # of one bulk transfer, its two bytes of header included


def frames_of(path):
    """Every frame of a Y4M file as (width, height, [YUYV bytes])."""
    with open(path, "rb") as file:
        fields = {word[:1]: word[1:] for word in file.readline().decode().split()[1:]}
        width, height = int(fields["W"]), int(fields["H"])
        luma_bytes = width * height
        chroma_bytes = 0 if fields.get("C", "420").startswith("mono") else 2 * ((width + 1) // 2) * ((height + 1) // 2)
        frames = []
        while file.readline().startswith(b"FRAME"):
            luma = file.read(luma_bytes)
            file.read(chroma_bytes)
            packed = bytearray(b"\x80") * (2 * luma_bytes)
            packed[::2] = luma
            frames.append(bytes(packed))
    return width, height, frames


def block(kind, content):
    """One descriptor: its length, its kind, its content."""
    return bytes([2 + len(content), kind]) + content


def utf16(text):
    return block(3, text.encode("utf-16-le"))


class Descriptors:
    """What the camera tells about itself (USB 2.0 chapter 9; UVC 1.1 sections 3.7, 3.9 and the uncompressed payload)."""

    def __init__(self, width, height, rate):
        self.frame_bytes = 2 * width * height
        self.interval = 10_000_000 // rate  # 100 ns
        self.device = block(1, struct.pack("<HBBBBHHHBBBB", 0x200, 0xEF, 2, 1, 64, VENDOR, PRODUCT, 0x100, 1, 2, 0, 1))
        self.strings = [block(3, b"\x09\x04"), utf16("pliant"), utf16("Camera without hardware")]
        # Both negotiation requests carry this: format 1, frame 1, the only ones.
        self.negotiation = struct.pack("<HBBIHHHHHII", 1, 1, 1, self.interval, 0, 0, 0, 0, 0, self.frame_bytes,
                                       PAYLOAD_BYTES)
        everything = self.control_interface() + self.streaming_interface(width, height, rate)
        self.configuration = block(2, struct.pack("<HBBBBB", 9 + len(everything), 2, 1, 0, 0x80, 50)) + everything

    def control_interface(self):
        camera = block(0x24, struct.pack("<BBHBBHHHB3x", 2, 1, 0x201, 0, 0, 0, 0, 0, 3))
        output = block(0x24, struct.pack("<BBHBBB", 3, 2, 0x101, 0, 1, 0))
        length = 13 + len(camera) + len(output)
        header = block(0x24, struct.pack("<BHHIBB", 1, 0x100, length, 48_000_000, 1, 1))
        association = block(11, bytes([0, 2, 14, 3, 0, 0]))
        return association + block(4, bytes([0, 0, 0, 14, 1, 0, 0])) + header + camera + output

    def streaming_interface(self, width, height, rate):
        yuy2 = b"YUY2" + bytes.fromhex("0000 1000 8000 00aa00389b71")
        layout = block(0x24, bytes([4, 1, 1]) + yuy2 + bytes([16, 1, 0, 0, 0, 0]))
        bits = 8 * self.frame_bytes * rate
        size = block(0x24, struct.pack("<BBBHHIIIIBI", 5, 1, 0, width, height, bits, bits, self.frame_bytes,
                                       self.interval, 1, self.interval))
        length = 14 + len(layout) + len(size)
        header = block(0x24, struct.pack("<BBHBBBBBBBB", 1, 1, length, STREAM_ENDPOINT, 0, 2, 0, 0, 0, 1, 0))
        endpoint = block(5, struct.pack("<BBHB", STREAM_ENDPOINT, 2, 512, 0))
        return block(4, bytes([1, 0, 1, 14, 2, 0, 0])) + header + layout + size + endpoint


class Player:
    """Cuts the frames, at their time, into payloads with the class's two bytes of header."""

    def __init__(self, frames, rate, unplug_after):
        self.frames, self.period, self.unplug_after = frames, 1.0 / rate, unplug_after
        self.restart()

    def restart(self):
        self.shown, self.rest, self.parity, self.due = 0, b"", 0, time.monotonic()

    def payload(self, room):
        if not self.rest:
            if self.shown == self.unplug_after:
                sys.exit(0)  # the socket closes with us: that is the plug
            time.sleep(max(0.0, self.due - time.monotonic()))
            self.due = max(self.due, time.monotonic() - self.period) + self.period
            self.rest = memoryview(self.frames[self.shown % len(self.frames)])
        size = min(room, PAYLOAD_BYTES) - 2
        piece, self.rest = self.rest[:size], self.rest[size:]
        last = len(self.rest) == 0
        header = bytes([2, 0x80 | (2 if last else 0) | self.parity])
        if last:
            self.parity ^= 1
            self.shown += 1
        return header + bytes(piece)


class Camera:
    """Answers QEMU, packet by packet."""

    def __init__(self, connection, descriptors, player):
        self.connection, self.descriptors, self.player = connection, descriptors, player
        self.long_ids = False

    def receive(self, count):
        data = b""
        while len(data) < count:
            more = self.connection.recv(count - len(data))
            if not more:
                sys.exit(0)
            data += more
        return data

    def send(self, kind, number, content):
        header = struct.pack("<IIQ" if self.long_ids else "<III", kind, len(content), number)
        self.connection.sendall(header + content)

    def say_hello(self):
        abilities = CAN_VERSION | CAN_PACKET_SIZE | CAN_LONG_IDS | CAN_LONG_BULK
        self.send(HELLO, 0, b"camera without hardware".ljust(64, b"\0") + struct.pack("<I", abilities))

    def plug_in(self, hello):
        theirs = struct.unpack_from("<I", hello, 64)[0] if len(hello) >= 68 else 0
        self.long_ids = bool(theirs & CAN_LONG_IDS)
        pad = lambda values: bytes(values).ljust(32, b"\0")
        self.send(INTERFACES, 0, struct.pack("<I", 2) + pad([0, 1]) + pad([14, 14]) + pad([1, 2]) + pad([0, 0]))
        # Of 16 endpoints out and 16 in: control in both ways (type 0), bulk in (type 2), nothing else (255).
        kind, interface, largest = [255] * 32, [0] * 32, [0] * 32
        kind[0] = kind[16] = 0
        largest[0] = largest[16] = 64
        kind[17], interface[17], largest[17] = 2, 1, 512
        self.send(ENDPOINTS, 0, bytes(kind) + bytes(32) + bytes(interface) + struct.pack("<32H", *largest))
        high_speed = 2
        self.send(CONNECT, 0, struct.pack("<BBBBHHH", high_speed, 0xEF, 2, 1, VENDOR, PRODUCT, 0x100))

    def answer_to_control(self, direction_and_type, request, value, index):
        """The bytes to give, empty for a plain yes, None to stall."""
        d = self.descriptors
        which = value >> 8
        if direction_and_type == 0x80 and request == 6:  # GET_DESCRIPTOR
            if which == 3:
                return d.strings[value & 255] if value & 255 < len(d.strings) else None
            return {1: d.device, 2: d.configuration}.get(which)
        if direction_and_type in (0x80, 0x81, 0x82) and request == 0:  # GET_STATUS
            return b"\0\0"
        if direction_and_type == 0x02 and request == 1:  # CLEAR_FEATURE: the endpoint is not halted any more
            self.player.rest = b""
            return b""
        if index & 255 != 1 or which not in (1, 2):  # only the streaming interface has controls: probe and commit
            return None
        if direction_and_type == 0x21 and request == 1:  # SET_CUR
            if which == 2:
                self.player.restart()
            return b""
        if direction_and_type == 0xA1:  # GET_CUR, _MIN, _MAX, _DEF; GET_LEN; GET_INFO
            return {0x85: struct.pack("<H", len(d.negotiation)), 0x86: b"\x03"}.get(request, d.negotiation)
        return None

    def control(self, number, packet):
        endpoint, request, kind, _, value, index, length = struct.unpack_from("<BBBBHHH", packet)
        answer = self.answer_to_control(kind, request, value, index)
        status = STALL if answer is None else 0
        content = (answer or b"")[:length]
        done = len(content) if kind & 0x80 else (0 if status else length)
        self.send(CONTROL, number, struct.pack("<BBBBHHH", endpoint, request, kind, status, value, index, done) + content)

    def bulk(self, number, packet):
        endpoint, _, low, stream, high = struct.unpack_from("<BBHIH", packet)
        content = self.player.payload(low | high << 16)
        size = len(content)
        self.send(BULK, number, struct.pack("<BBHIH", endpoint, 0, size & 0xFFFF, stream, size >> 16) + content)

    def run(self):
        self.say_hello()
        while True:
            kind, length, number = struct.unpack("<IIQ" if self.long_ids else "<III", self.receive(16 if self.long_ids else 12))
            packet = self.receive(length)
            if kind == HELLO:
                self.plug_in(packet)
            elif kind in (SET_CONFIGURATION, GET_CONFIGURATION):
                self.send(CONFIGURATION, number, bytes([0, packet[0] if packet else 1]))
            elif kind in (SET_ALTERNATE, GET_ALTERNATE):
                self.send(ALTERNATE, number, bytes([0, packet[0], packet[1] if kind == SET_ALTERNATE else 0]))
            elif kind == CONTROL:
                self.control(number, packet)
            elif kind == BULK:
                self.bulk(number, packet)


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    path, rate = sys.argv[1], int(sys.argv[3])
    width, height, frames = frames_of(sys.argv[2])
    if os.path.exists(path):
        os.unlink(path)
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(path)
    listener.listen(1)
    connection, _ = listener.accept()
    player = Player(frames, rate, int(sys.argv[4]) if len(sys.argv) == 5 else -1)
    Camera(connection, Descriptors(width, height, rate), player).run()


main()
