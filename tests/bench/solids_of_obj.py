"""Solids of the generated OBJ files, and whether two of them overlap: plain Python, for tests."""
import collections
import math


class Solid:
    """A convex polyhedron: `planes` are (nx, ny, nz, d) with n.x <= d inside, n outward and unit."""

    def __init__(self, vertices, faces):
        self.vertices = vertices
        self.low = [min(v[i] for v in vertices) for i in range(3)]
        self.high = [max(v[i] for v in vertices) for i in range(3)]
        self.centre = [sum(v[i] for v in vertices) / len(vertices) for i in range(3)]
        self.reach = max(math.dist(self.centre, v) for v in vertices)
        self.planes = []
        for face in faces:
            a, b, c = (vertices[i] for i in face[:3])
            u = [b[i] - a[i] for i in range(3)]
            v = [c[i] - a[i] for i in range(3)]
            n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            length = math.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
            n = tuple(x / length for x in n)
            self.planes.append((*n, n[0] * a[0] + n[1] * a[1] + n[2] * a[2]))

    def separates(self, other, slack):
        """Does one of this solid's faces have all of `other` outside, but for `slack`?"""
        return any(all(nx * x + ny * y + nz * z > d - slack for x, y, z in other.vertices)
                   for nx, ny, nz, d in self.planes)


def read_solids(path):
    """Solids of an OBJ file in which every solid has vertices of its own, listed before its faces."""
    solids, vertices, faces, first = [], [], [], 1
    with open(path, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("v "):
                if faces:
                    solids.append(Solid(vertices, faces))
                    first += len(vertices)
                    vertices, faces = [], []
                vertices.append(tuple(float(x) for x in line.split()[1:]))
            elif line.startswith("f "):
                faces.append([int(i) - first for i in line.split()[1:]])
    solids.append(Solid(vertices, faces))
    return solids


def overlapping_pairs(solids, slack):
    """Pairs of indices that neither boxes, nor balls about their centres, nor a face plane of either keeps apart. Touching
    within `slack` is apart. Two solids that only an edge-edge plane separates would be listed too."""
    size = max(1e-9, sorted(max(h - l for l, h in zip(s.low, s.high)) for s in solids)[len(solids) // 2])
    grid = collections.defaultdict(list)
    pairs = set()
    for index, s in enumerate(solids):
        cells = [range(math.floor((s.low[i] + slack) / size), math.floor((s.high[i] - slack) / size) + 1) for i in range(3)]
        near = set()
        for x in cells[0]:
            for y in cells[1]:
                for z in cells[2]:
                    near.update(grid[x, y, z])
                    grid[x, y, z].append(index)
        for other in near:
            o = solids[other]
            if any(s.low[i] > o.high[i] - slack or o.low[i] > s.high[i] - slack for i in range(3)):
                continue
            if math.dist(s.centre, o.centre) > s.reach + o.reach - slack:
                continue
            if not s.separates(o, slack) and not o.separates(s, slack):
                pairs.add((other, index))
    return pairs


def floating(solids, ground, slack):
    """Indices of solids that neither reach down to the height `ground` nor rest on another's top, boxes compared."""
    tops = collections.defaultdict(list)
    for s in solids:
        tops[round(s.high[2] / slack)].append(s)

    def rests(s):
        key = round(s.low[2] / slack)
        below = tops[key - 1] + tops[key] + tops[key + 1]
        return any(all(s.low[i] < o.high[i] and o.low[i] < s.high[i] for i in (0, 1)) for o in below if o is not s)

    return [i for i, s in enumerate(solids) if s.low[2] > ground + slack and not rests(s)]
