/** The models of a BOP dataset. */
import { readBopModel } from "../bop-folder.js";
import { formatsModule } from "../formats-module.js";
import { readMesh } from "../input/mesh.js";

/** The models in a folder, each read once. */
export class BopModels {
  readonly #folder: string;
  readonly #withColors: boolean;
  readonly #meshes = new Map<number, Promise<object>>();

  constructor(folder: string, withColors: boolean) {
    this.#folder = folder;
    this.#withColors = withColors;
  }

  /** The arrays of a model, in millimetres, and the warnings of its reader. */
  mesh(objectId: number): Promise<object> {
    const known = this.#meshes.get(objectId);
    if (known !== undefined) return known;
    const reading = this.#read(objectId);
    this.#meshes.set(objectId, reading);
    return reading;
  }

  async #read(objectId: number): Promise<object> {
    const file = await readBopModel(this.#folder, objectId);
    const { mesh, warnings } = await readMesh(file, () => formatsModule.load(), this.#withColors);
    return { ...mesh, warnings };
  }
}
