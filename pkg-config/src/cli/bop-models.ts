/** The models of a BOP dataset. */
import { readBopModel } from "../bop-folder.js";
import { readMesh } from "../input/mesh.js";
import { fileReaders } from "../modules/readers.js";
import { oncePerKey } from "../values/values.js";

/** The models in a folder by their ids, each read once: arrays in millimetres, and the warnings of the reader. */
export const bopModelsIn = (folder: string, withColors: boolean): ((objectId: number) => Promise<object>) =>
  oncePerKey(async (objectId) => {
    const file = await readBopModel(folder, objectId);
    const { mesh, warnings } = await readMesh(file, fileReaders, withColors);
    return { ...mesh, warnings };
  });
