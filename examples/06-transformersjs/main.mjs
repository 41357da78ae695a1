// node main.mjs IMAGE MESH U,V FOVY_DEG: aligns a mesh with the object at pixel (U, V) of a photo.
// transformers.js downloads the models on the first run.
import { readFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { alignTensors } from "./align-tensors.mjs";

const [image, meshFile, pixel, fovYDeg] = process.argv.slice(2);
if (!image || !meshFile || !pixel || !fovYDeg) throw new Error("Usage: node main.mjs IMAGE MESH U,V FOVY_DEG");
const { AutoProcessor, RawImage, SamModel, pipeline } = await import("@huggingface/transformers").catch(() => {
  throw new Error("transformers.js is missing. Remedy: npm install @huggingface/transformers");
});

// Any model of metric depth. For a relative one, pass { disparity: { scale, shift } } below.
const depthModel = process.env.DEPTH_MODEL ?? "onnx-community/DepthPro-ONNX";
const maskModel = process.env.MASK_MODEL ?? "Xenova/sam-vit-base";

const picture = await RawImage.read(image);
const estimator = await pipeline("depth-estimation", depthModel);
const { predicted_depth } = await estimator(picture);

const sam = await SamModel.from_pretrained(maskModel);
const processor = await AutoProcessor.from_pretrained(maskModel);
const inputs = await processor(picture, { input_points: [[pixel.split(",").map(Number)]] });
const { pred_masks, iou_scores } = await sam(inputs);
const [masks] = await processor.post_process_masks(pred_masks, inputs.original_sizes, inputs.reshaped_input_sizes);

const aligner = await createAligner();
const mesh = await readFile(meshFile);
const found = { predicted_depth, masks, iou_scores, disparity: undefined, image: picture.rgb() };
const result = await alignTensors(aligner, found, { fovYDeg: Number(fovYDeg) }, mesh);
console.log({ scale: result.scale, translation: result.translation, confidence: result.confidence });
