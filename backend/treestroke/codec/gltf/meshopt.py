"""Bit streams of glTF's EXT_meshopt_compression, by its specification (Khronos, appendices A and B).

======  ====================================================================
letter  meaning
======  ====================================================================
n       elements (vertices, keyframes)
s       bytes in an element, a multiple of 4
g       groups of 16 elements
t       triangles
======  ====================================================================
"""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Indices

Bytes = NDArray[np.uint8]

_ATTRIBUTES, _TRIANGLES = 0xA0, 0xE1  # the streams' first bytes
_GROUP, _GROUPS_A_BYTE, _BLOCK_BYTES, _BLOCK_ELEMENTS = 16, 4, 8192, 256
_TAIL = 32  # least bytes after the last block; they end with the baseline, the element before the first
_EDGES, _VERTICES, _EDGE_VERTICES = 15, 14, 12  # entries of the FIFOs that a code can refer to
_TABLE = 16  # bytes of the codeaux table that ends the triangles; the last two stay 0
_PAIRS = bytes.fromhex(
    "00 76 65 75 86 45 87 56 02 03 97 67 78 a7"
)  # codeaux: most frequent second and third corners, on two trees
_NEXT, _BEFORE, _AFTER, _FAR = (
    0x0,
    0xD,
    0xE,
    0xF,
)  # codes of a corner: the next vertex, one before or after the last, in full
_TABLED, _UNTABLED, _NONE_NEXT = 0xF0, 0xFE, 0xFF  # codes of triangles that share no edge in the FIFO

_QUAD, _QUAD_CODES = np.array([0, 1, 2, 0, 2, 3]), b"\xf0\x00"
"""The triangles of a card, and their codes: three next vertices, then the last edge and the next vertex."""


def encode_attributes(elements: Bytes) -> bytes:
    """Encode elements (n, s) in the mode ATTRIBUTES, version 0: each byte as its change from the element before.

    Raises
    ------
    ValueError
        There are no elements, or their size is not a multiple of 4 up to 256.
    """
    count, stride = elements.shape
    if not count or stride % 4 or not 4 <= stride <= 256:
        raise ValueError(f"there must be elements of 4, 8 ... 256 bytes, got {elements.shape}")
    groups = -(-count // _GROUP)
    changes = np.zeros((groups * _GROUP, stride), dtype=np.uint8)
    changes[1:count] = np.diff(elements, axis=0)
    folded = (changes << 1) ^ (0 - (changes >> 7))
    rows = np.ascontiguousarray(folded.reshape(groups, _GROUP, stride).transpose(0, 2, 1))
    block = min((_BLOCK_BYTES // stride) & ~(_GROUP - 1), _BLOCK_ELEMENTS) // _GROUP
    whole = groups - groups % block
    streams = [_blocks(rows[:whole], block), _blocks(rows[whole:], groups - whole)]
    baseline: bytes = elements[0].tobytes()
    return bytes([_ATTRIBUTES]) + b"".join(streams) + baseline.rjust(_TAIL, b"\0")


def encode_triangles(triangles: NDArray[np.integer]) -> bytes:
    """Encode triangles (t, 3) in the mode TRIANGLES, version 1; corners may rotate, never flip.

    A triangle takes one byte if vertices are numbered in the order of their first use and it shares an edge with one of
    the few triangles before it.
    """
    quads, rest = divmod(len(triangles), 2)
    if not rest and np.array_equal(triangles.reshape(-1, 6), np.arange(quads)[:, None] * 4 + _QUAD):
        return bytes([_TRIANGLES]) + _QUAD_CODES * quads + _PAIRS.ljust(_TABLE, b"\0")
    writer = _Triangles(int(triangles.max(initial=0)) + 1)
    for a, b, c in triangles.tolist():
        if not writer.share_edge(a, b, c):
            writer.stand_alone(a, b, c)
    return writer.stream()


def octahedral(directions: NDArray[np.floating]) -> Bytes:
    """Encode unit vectors (n, 3), or (n, 4) with a sign, as elements (n, 4) of 8 bit for the filter OCTAHEDRAL."""
    vectors = directions[:, :3].astype(np.float64)
    x, y, z = (vectors / np.maximum(np.abs(vectors).sum(axis=1, keepdims=True), 1e-9)).T
    fold = np.maximum(-z, 0.0)
    across, down = x + np.copysign(fold, x), y + np.copysign(fold, y)
    sign = directions[:, 3] if directions.shape[1] == 4 else np.zeros_like(x)
    whole: NDArray[np.int8] = np.rint(np.stack([across, down, np.ones_like(x), sign], axis=1) * 127).astype(np.int8)
    return whole.view(np.uint8)


def fixed_point(values: NDArray[np.floating], bits: int) -> Bytes:
    """Round values (n, c) to multiples of 2 to the power of -``bits``: elements (n, 4 c) for the filter EXPONENTIAL.

    If a value needs more than 24 bits, all are rounded to larger multiples.
    """
    bits = min(bits, 22 - int(np.frexp(np.abs(values).max(initial=0))[1]))
    multiples = np.rint(values.astype(np.float64) * 2.0**bits).astype(np.int64)
    return ((multiples & 0xFFFFFF) | ((-bits & 0xFF) << 24)).astype("<u4").view(np.uint8)


def _blocks(rows: Bytes, block: int) -> bytes:
    """Encode groups (g, s, 16) in blocks of ``block`` groups: for each byte of the elements headers, then data."""
    if not len(rows):
        return b""
    packed = (each.reshape(-1, block, *each.shape[1:]).swapaxes(1, 2) for each in _packed(rows))
    bodies, sizes, modes = packed
    blocks, stride, heads = len(modes), rows.shape[1], -(-block // _GROUPS_A_BYTE)
    padded = np.zeros((blocks, stride, heads * _GROUPS_A_BYTE), dtype=np.uint8)
    padded[..., :block] = modes
    shifted = padded.reshape(blocks, stride, heads, _GROUPS_A_BYTE) << np.array([0, 2, 4, 6], dtype=np.uint8)
    pieces = np.zeros((blocks, stride, heads + block, _GROUP), dtype=np.uint8)
    lengths = np.ones(pieces.shape[:3], dtype=np.int64)
    pieces[:, :, :heads, 0], pieces[:, :, heads:], lengths[:, :, heads:] = shifted.sum(3), bodies, sizes
    return pieces[np.arange(_GROUP) < lengths[..., None]].tobytes()


def _packed(rows: Bytes) -> tuple[Bytes, Indices, Bytes]:
    """Choose the shortest form of each row of 16 bytes (g, s, 16): (data, its sizes, header bits)."""
    over = [(rows >= sentinel).sum(axis=2) for sentinel in (1, 3, 15)]
    costs = np.stack([np.where(over[0] > 0, 99, 0), 4 + over[1], 8 + over[2], np.full_like(over[0], 16)], axis=2)
    modes = costs.argmin(axis=2).astype(np.uint8)
    bodies = rows.copy()
    for mode, bits in ((1, 2), (2, 4)):
        chosen = modes == mode
        bodies[chosen] = _with_sentinels(rows[chosen], bits)
    return bodies, np.take_along_axis(costs, modes[..., None].astype(np.int64), axis=2)[..., 0], modes


def _with_sentinels(rows: Bytes, bits: int) -> Bytes:
    """Pack rows (k, 16) into ``bits`` for each value, all ones for values that follow as whole bytes: (k, 16)."""
    sentinel, each = 2**bits - 1, 8 // bits
    large = rows >= sentinel
    shifts = np.arange(8 - bits, -1, -bits, dtype=np.uint8)
    packed = (np.where(large, sentinel, rows).astype(np.uint8).reshape(-1, _GROUP // each, each) << shifts).sum(2)
    whole = np.take_along_axis(rows, np.argsort(~large, axis=1, kind="stable"), axis=1)
    return np.concatenate([packed.astype(np.uint8), whole], axis=1)[:, :_GROUP]


class _Triangles:
    """Encoder of the mode TRIANGLES: the state that the decoder will have, and the codes written so far.

    The FIFOs are kept as the time at which each edge and vertex was last pushed: its position is how long ago that was.
    """

    def __init__(self, vertices: int) -> None:
        self.codes, self.extra = bytearray(), bytearray()
        self.next = self.last = 0
        self.edges: dict[tuple[int, int], int] = {}
        self.pushed_edges = 0
        self.vertices = [-_GROUP] * vertices
        self.pushed_vertices = 0

    def share_edge(self, a: int, b: int, c: int) -> bool:
        """Encode a triangle by an edge that is in the FIFO; return whether there is one."""
        edges, now = self.edges, self.pushed_edges
        for first, second, third in ((a, b, c), (b, c, a), (c, a, b)):
            ago = now - 1 - edges.get((first, second), -_GROUP)
            if ago < _EDGES:
                self.codes.append(ago << 4 | self._third(third))
                edges[third, second], edges[first, third] = now, now + 1
                self.pushed_edges = now + 2
                return True
        return False

    def stand_alone(self, a: int, b: int, c: int) -> None:
        """Encode a triangle by its corners, the next vertex first if it is one of them."""
        if self.next in (b, c):
            a, b, c = (b, c, a) if self.next == b else (c, a, b)
        start, begins = len(self.extra), self.next == a
        if begins:
            self.next += 1
        else:
            self._encode_far(a)
        second, third = self._corner(b), self._corner(c)
        tabled = _PAIRS.find(second << 4 | third) if begins else -1
        if tabled < 0:
            self.extra.insert(start, second << 4 | third)
        self.codes.append(_TABLED | tabled if tabled >= 0 else _UNTABLED if begins else _NONE_NEXT)
        for vertex, code in ((a, _NEXT), (b, second), (c, third)):
            if code in (_NEXT, _FAR):
                self._push(vertex)
        self.edges[b, a], self.edges[c, b], self.edges[a, c] = range(self.pushed_edges, self.pushed_edges + 3)
        self.pushed_edges += 3

    def stream(self) -> bytes:
        """Join the parts of the stream."""
        return bytes([_TRIANGLES]) + self.codes + self.extra + _PAIRS.ljust(_TABLE, b"\0")

    def _third(self, c: int) -> int:
        """Encode the corner opposite to a shared edge and return its code."""
        ago = self.pushed_vertices - 1 - self.vertices[c]
        if 0 < ago <= _EDGE_VERTICES:
            return ago
        self._push(c)
        if c == self.next:
            self.next += 1
            return _NEXT
        if c in (self.last - 1, self.last + 1):
            code = _BEFORE if c < self.last else _AFTER
            self.last = c
            return code
        self._encode_far(c)
        return _FAR

    def _corner(self, vertex: int) -> int:
        """Encode the second or third corner of a triangle without a shared edge and return its code."""
        if vertex == self.next:
            self.next += 1
            return _NEXT
        ago = self.pushed_vertices - 1 - self.vertices[vertex]
        if ago < _VERTICES:
            return ago + 1
        self._encode_far(vertex)
        return _FAR

    def _encode_far(self, vertex: int) -> None:
        """Encode a vertex in full, by its distance from the last one encoded so."""
        change = vertex - self.last
        folded = change * 2 if change >= 0 else -change * 2 - 1
        while folded > 0x7F:
            self.extra.append(0x80 | folded & 0x7F)
            folded >>= 7
        self.extra.append(folded)
        self.last = vertex

    def _push(self, vertex: int) -> None:
        self.vertices[vertex] = self.pushed_vertices
        self.pushed_vertices += 1
