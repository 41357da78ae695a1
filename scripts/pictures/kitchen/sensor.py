"""Depth and masks as networks return them."""

import numpy as np
from scipy import ndimage


def _smooth(shape, sigma, rng):
    """Smooth noise of mean 0 and standard deviation 1."""
    field = ndimage.gaussian_filter(rng.normal(size=shape), sigma)
    return (field - field.mean()) / field.std()


def depth_seen(depth, rng):
    """Blurred edges, and errors that vary slowly: in metres."""
    # Networks blur edges in the inverse of the depth.
    blurred = 1 / ndimage.gaussian_filter(1 / depth, 1.1)
    return blurred * (1 + 0.0025 * _smooth(depth.shape, 55, rng) + 0.001 * _smooth(depth.shape, 9, rng))


def mask_seen(mask, grown_px, rng):
    """A smooth outline that is a little too far out, or in."""
    distance = ndimage.distance_transform_edt(mask) - ndimage.distance_transform_edt(~mask)
    rounded = ndimage.gaussian_filter(distance, 1.6) + grown_px + 0.7 * _smooth(mask.shape, 7, rng)
    parts, count = ndimage.label(rounded > 0)
    sizes = ndimage.sum_labels(rounded > 0, parts, range(1, count + 1))
    return parts == 1 + int(np.argmax(sizes))
