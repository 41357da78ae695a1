"""Other libraries' registration on our cases, and on pairs of clouds: `python -m peers --help`.

Every method gets the unified preprocessing of the paper (frames.py): P_obs by back-projection of the masked depth,
P_rec sampled on the mesh, both centred, each scaled to a box diagonal of 1, which is the heuristic scale
s_init = diagonal(P_obs) / diagonal(P_rec). methods.py lists the methods with their settings. The time is that of the
method with its preprocessing, without reading files.
"""
