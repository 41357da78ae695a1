/** A shot: an observation and a mesh, decoded for pictures of a pose. */

import { toOrigin } from "../calls/origin.js";
import type { Pinhole } from "../camera/pinhole.js";
import { resizedMask } from "../conventions/resize.js";
import { metresPerUnit } from "../input/depth.js";
import { readPhoto } from "../input/photo.js";
import { resolveInput } from "../input/resolve.js";
import type { Photo } from "../modules/core-input.js";
import { coreModule } from "../modules/modules.js";
import { fileReaders } from "../modules/readers.js";
import type { AlignInput } from "../types/inputs.js";
import type { MaskPixels } from "../values/pixels.js";
import { type CoreMesh, nextMeshId } from "../values/prepared-mesh.js";
import type { View } from "./view.js";

/** The decoded input of pictures. The core keeps its mesh until it is disposed. */
export class Shot {
  private constructor(
    /** Metres, row by row; 0 is no reading. */
    readonly depth: Float32Array,
    readonly width: number,
    readonly height: number,
    readonly camera: Pinhole,
    /** The mask at the size of the depth map; not 0 in the object. */
    readonly mask: MaskPixels,
    readonly photo: Photo | undefined,
    readonly mesh: CoreMesh,
  ) {}

  /**
   * Decodes an input with depth and a camera.
   * @throws {@link Sim3AlignError} as `align`
   */
  static async of(input: AlignInput): Promise<Shot> {
    const { image: photo, ...plain } = input;
    // Without a photo, whose data may state the focal length, the colours of the mesh are not read: no picture shows them.
    const hasCamera = input.camera !== undefined || input.cameraFile !== undefined;
    const { core } = await resolveInput(hasCamera ? plain : input, fileReaders, nextMeshId());
    const { depth = new Float32Array(), mask, mesh } = core;
    const size = { width: Number(core.width), height: Number(core.height) };
    const { image } = hasCamera ? await readPhoto(photo, size, fileReaders) : core;
    const { width, height } = size;
    const scale = metresPerUnit(depth, core.depthScale);
    const metres = new Float32Array(depth.length);
    for (let i = 0; i < depth.length; i++) {
      const z = depth[i] as number;
      if (z > 0 && z < Number.POSITIVE_INFINITY) metres[i] = z * scale;
    }
    const given = { data: mask, width: core.maskWidth ?? width, height: core.maskHeight ?? height };
    const isSameSize = given.width === width && given.height === height;
    const inside = isSameSize ? mask : resizedMask(given, { width, height }).data;
    return new Shot(metres, width, height, core.camera as Pinhole, inside, image, mesh);
  }

  /** The depth of the mesh at a pose in a view, metres; 0 where no mesh is. By default, its camera is that of the input. */
  async render(view: View, matrix: readonly number[], camera = view.camera(this.camera)): Promise<Float32Array> {
    const core = await coreModule.load();
    const { width, height } = view;
    return core.call((c) => c.renderDepth({ mesh: this.mesh, width, height, camera }, this.ofArrays(matrix)));
  }

  /** The matrix that places the arrays of the mesh, of one that places the mesh in its file. */
  readonly ofArrays = (matrix: readonly number[]): readonly number[] => toOrigin(matrix, this.mesh.fileOrigin);

  /** Frees what the core keeps of the mesh. */
  async dispose(): Promise<void> {
    const { id } = this.mesh;
    if (id !== undefined) (await coreModule.load()).call((c) => c.dropMesh(id));
  }
}
