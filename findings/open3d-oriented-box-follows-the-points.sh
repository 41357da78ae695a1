#!/usr/bin/env bash
# Open3D: the oriented bounding box of a cuboid is larger than the cuboid, and than its box along the axes.
#
# One would expect: get_oriented_bounding_box() of points on a cuboid returns that cuboid, however its points are spread: all
# of its corners are among them.
#
# What happens: the axes of the box are the principal axes of the vertices of the hull (or, of a mesh, of all that it has). Where
# one corner of the cuboid has more vertices than the others, as rounded edges, a handle or a printed label have, the box turns
# towards it: a cuboid of 30 x 20 x 10 cm with one rounded corner comes out longer, and with more volume than the box along the axes
# has. get_minimal_oriented_bounding_box() returns the cuboid, as trimesh's bounding_box_oriented does.
#
# Versions: open3d 0.20.0, trimesh 5.2.0, scipy 1.17.1, numpy 2.4.6, Python 3.11.
#
# Why it matters: cuboids for annotation, grasping and "how large is it" are read from this function. With a scale from a
# ruler, divided by the longest side of this box, the object is some percent too small, and all depth behind it too near.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet open3d==0.20.0 trimesh==5.2.0 scipy==1.17.1 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import itertools

import numpy as np
import open3d as o3d
import trimesh

size = np.array([0.3, 0.2, 0.1])
corners = np.array(list(itertools.product((0, 1), repeat=3))) * size
# One corner is rounded with a radius of 1 cm: many vertices, all inside of the cuboid.
rng = np.random.default_rng(0)
sphere = np.abs(rng.normal(size=(300, 3)))
rounded = size - 0.01 + 0.01 * sphere / np.linalg.norm(sphere, axis=1, keepdims=True)
points = np.r_[corners[:-1], rounded]

cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
along = cloud.get_axis_aligned_bounding_box()
oriented, minimal = cloud.get_oriented_bounding_box(), cloud.get_minimal_oriented_bounding_box()
other = trimesh.PointCloud(points).bounding_box_oriented.primitive.extents
show = lambda extent: " x ".join(f"{100 * side:.1f}" for side in sorted(extent, reverse=True)) + " cm"
print(f"open3d {o3d.__version__}: along the axes {show(along.get_extent())}, oriented {show(oriented.extent)}")
print(f"minimal {show(minimal.extent)}, trimesh {trimesh.__version__} {show(other)}")
ratio = oriented.volume() / along.volume()
print(f"the oriented box has {ratio:.2f} times the volume of the box along the axes")
assert ratio > 1.05, "the behaviour has changed"
assert np.allclose(sorted(minimal.extent), sorted(size), atol=0.003), "the behaviour has changed"
assert np.allclose(sorted(other), sorted(size), atol=0.003), "the behaviour has changed"
PYTHON
