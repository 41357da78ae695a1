/** The content of mesh files and of the EXIF data of photos, as the readers return it. */

import type { PixelArray } from "../values/pixels.js";

/** Colours of a surface, at points spread evenly over it. */
export interface ColorSamples {
  /** Interleaved x, y, z per point, in the frame of the mesh. */
  positions: Float32Array;
  /** The unit normal of the surface at each point, outward: interleaved x, y, z. */
  normals: Float32Array;
  /** Red, green and blue per point, sRGB-encoded. */
  colors: Uint8Array;
  /** The same if the textures were stored upside down, with which `align` compares a photo that contradicts `colors`. */
  flippedColors?: Uint8Array | undefined;
}

/** A mesh from a file, in the unit and axes of the file. */
export interface MeshFromFile {
  /** Interleaved x, y, z. */
  positions: Float32Array;
  /**
   * What was subtracted from the coordinates of the file, if these are far from zero, as in a map: 32-bit numbers would not
   * resolve them. Poses of these arrays are relative to it.
   */
  origin?: [number, number, number];
  /** Three vertex indices per triangle. */
  indices: Uint32Array;
  /** The colours of the surface, from vertices, materials and textures, if the file has any that can be read. */
  samples?: ColorSamples;
  /** How many copies of one mesh a glTF file places, if it has no other mesh; all of them are read as one object. */
  copies?: number;
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
  /** Why the colours cannot be read; empty if they can, or if there are none. */
  warnings: string[];
}

/** A mask from a file, row-major; 1 is the object. */
export interface MaskFromFile extends PixelArray<Uint8Array> {
  /** Which values of the file are the object: `"values of 127.5 or more, of 0 to 255"`; of JSON, which of several masks. */
  reading?: string;
  /** Content of the file that its reader does not know. */
  unread?: readonly string[];
}

/** The files that a mesh file refers to, by the names in it. */
export interface ExternalResources {
  /** The buffers of a `.gltf`, without which it cannot be read. */
  shape: string[];
  /** Textures and material libraries, without which it has no colours. */
  colors: string[];
}

/** The camera by the EXIF data of a photo; properties that they do not state are missing. */
export interface Exif {
  /** Focal length with the same diagonal field of view on a frame of 36 × 24 mm, in mm: `FocalLengthIn35mmFilm`. */
  focalLength35mm?: number;
  /** Focal length of the lens, in mm. */
  focalLengthMm?: number;
  /** Width of the sensor as far as the original image shows it, in mm. */
  sensorWidthMm?: number;
  /** How many times the camera enlarged the image. */
  digitalZoom?: number;
  make?: string;
  model?: string;
  /** 1 to 8; from 5, the stored image is viewed with its sides exchanged. 1 if the data state none. */
  orientation: number;
  /** Width of the original image as stored, in pixels. */
  width?: number;
  /** Height of the original image as stored, in pixels. */
  height?: number;
}
