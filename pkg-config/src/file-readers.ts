/** The modules that read files. */
import { depthFilesModule, type LoadDepthFiles } from "./depth-files-module.js";
import { formatsModule, type LoadFormats } from "./formats-module.js";
import { type LoadSplats, splatsModule } from "./splats-module.js";

/** Loads each module when a file first needs it. */
export interface FileReaders {
  formats: LoadFormats;
  depthFiles: LoadDepthFiles;
  splats: LoadSplats;
}

/** The readers that are shared by all aligners of this realm. */
export const fileReaders: FileReaders = {
  formats: () => formatsModule.load(),
  depthFiles: () => depthFilesModule.load(),
  splats: () => splatsModule.load(),
};
