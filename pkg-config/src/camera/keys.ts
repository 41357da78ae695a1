/**
 * The keys of camera files: one table, from which they are read. A key is in lower case, without other signs than letters and
 * digits; {@link meaningOf} also knows it behind `camera`, and beside the name of one of several cameras.
 */

/** What a key says; `other` does not matter for intrinsics. */
export type Meaning =
  | "fx"
  | "fy"
  | "cx"
  | "cy"
  | "focal"
  | "center"
  | "matrix"
  | "skew"
  | "width"
  | "height"
  | "size"
  | "shape"
  | "region"
  | "binningX"
  | "binningY"
  | "fovX"
  | "fovY"
  | "fov"
  | "apertureX"
  | "apertureY"
  | "aperture"
  | "metresPerUnit"
  | "unitsPerMetre"
  | "depthScale"
  | "scale"
  | "unit"
  | "distortion"
  | "coefficient"
  | "model"
  | "up"
  | "other";

/** A row of the table: the meaning, the keys, and programs that write them. */
type Row = readonly [meaning: Meaning, keys: string, by: string];

/** The table. */
export const keyTable: readonly Row[] = [
  ["fx", "fx flx focalx focallengthx fu", "RealSense, Polycam, nerfstudio, instant-ngp, ORB-SLAM, ZED, Replica, DOPE"],
  ["fy", "fy fly focaly focallengthy fv", "RealSense, nerfstudio, ORB-SLAM, ZED"],
  ["cx", "cx ppx u0 cu mx principalpointx", "RealSense, nerfstudio, ScanNet"],
  ["cy", "cy ppy v0 cv my principalpointy", "RealSense, nerfstudio, ScanNet"],
  [
    "focal",
    "f focal focals focallength focallengths focalpx focallengthpx fpx fc lens focallengthmm",
    "DUSt3R, Depth Pro, Unity, MATLAB, Isaac Sim, Blender",
  ],
  ["center", "pp principalpoint principalpoints opticalcenter cc", "DUSt3R, Unity, MATLAB"],
  [
    "matrix",
    "k kmat kmatrix camk camerak intr intrinsic intrinsics intrinsicmatrix intrinsicsmatrix intrinsicmat cameramatrix camintrinsic camintrinsics cameraintrinsic cameraintrinsics cammat mtx mcalibrationintrinsic",
    "BOP, FoundationPose, ROS, OpenCV, Open3D, Record3D, ARKit, Kalibr, HOPE, DepthAI, MATLAB, MoGe, VGGT",
  ],
  ["skew", "skew s skx", "NDDS, MATLAB"],
  [
    "width",
    "w width imagewidth imgwidth resx resolutionx resolutionwidth mwidth",
    "RealSense, Polycam, ROS, Open3D, Record3D",
  ],
  [
    "height",
    "h height imageheight imgheight resy resolutiony resolutionheight mheight",
    "RealSense, Polycam, ROS, Open3D, Record3D",
  ],
  [
    "size",
    "size imagesize imgsize resolution imageresolution renderproductresolution referencedimensions intrinsicmatrixreferencedimensions",
    "Kalibr, ZED, ARKit, Isaac Sim",
  ],
  ["shape", "shape imageshape imgshape hw imagehw", "MATLAB"],
  ["region", "roi", "ROS"],
  ["binningX", "binningx", "ROS"],
  ["binningY", "binningy", "ROS"],
  [
    "fovX",
    "fovx fovxdeg fovxrad hfov horizontalfov fovh xfov fovhorizontal horizontalfieldofview cameraanglex",
    "MoGe, nerfstudio, Habitat",
  ],
  [
    "fovY",
    "fovy fovydeg fovyrad vfov verticalfov fovv yfov fovvertical verticalfieldofview cameraangley",
    "MuJoCo, MoGe, glTF",
  ],
  ["fov", "fov fovdeg fovrad fieldofview", "CARLA, three.js, Unity"],
  ["apertureX", "aperturex horizontalaperture sensorwidth filmwidth", "USD, Isaac Sim, Blender"],
  ["apertureY", "aperturey verticalaperture sensorheight filmheight", "USD, Isaac Sim, Blender"],
  ["aperture", "aperture sensorsize", "Isaac Sim"],
  ["metresPerUnit", "depthunitscalefactor integerdepthscale depthtometers depthtometres", "nerfstudio, NeRFCapture"],
  [
    "unitsPerMetre",
    "factordepth depthfactor pngdepthscale depthmapfactor rgbddepthmapfactor depthscalingfactor depthshift mshift depthdivisor unitspermeter unitspermetre",
    "GraspNet, YCB-Video, NICE-SLAM, ORB-SLAM, ScanNet",
  ],
  ["depthScale", "depthscale depthscalefactor depthunitscale depthmultiplier", "BOP, RealSense, Open3D"],
  ["scale", "scale", "Replica"],
  ["unit", "depthunit depthunits", "RealSense"],
  [
    "distortion",
    "d dist disto distortion distcoef distcoeffs distortioncoef distortioncoeff distortioncoeffs distortioncoefs distortioncoefficient distortioncoefficients distortionparams distortionparameters distortionvector coef coeffs coefficients kc radialdistortion tangentialdistortion lensdistortionlookuptable",
    "ROS, OpenCV, RealSense, ZED, Kalibr, DepthAI, MATLAB, ARKit",
  ],
  ["coefficient", "k1 k2 k3 k4 k5 k6 p1 p2", "nerfstudio, ORB-SLAM, ZED, Azure Kinect"],
  [
    "model",
    "model cameramodel distortionmodel distortiontype lensmodel cameratype type projection projectiontype isfisheye fisheye fisheyemodel",
    "nerfstudio, ROS, Kalibr, ORB-SLAM, RealSense, Isaac Sim",
  ],
  ["up", "gravity gravityvector up cameraup updirection", "ARKit"],
];

/**
 * What else the files of these tools hold, and what says nothing about intrinsics or the unit of depth; `*` is any text. Whether
 * such a value is one number or a list makes a difference for `lists` only: one number may turn the image.
 */
const others = {
  poses:
    "*extrinsic* *pose *poses pose* *transform* *quaternion* *w2c* *c2w* *m2c* *world* *viewmatrix *lookat r t p rt q qvec tvec rvec rvecs tvecs t?? tic tbs tx ty tz qw qx qy qz tcam* tcn* tbc* tbody* location* position* *translation* *rectif* *projectionmatrix *homography* *essentialmatrix *fundamentalmatrix elev viewlevel sphere* r?rect rrect* tr axisalign* trvelo* trimu* trcam*",
  lists: "rotation* orientation* projection cameraprojection offset center",
  identity:
    "*time* *stamp* *serial* *version* *id *ids *uuid *name* *index *idx *count *number num* *date *fps* framerate rate seq header frame device* board* product* batch* hardware* misc* unit units *socket mode *path *neighbors *quality *keyframe*",
  stereo: "*baseline* bf *thdepth doffs ndisp vmin vmax isint disp* stereo* *stereo",
  scene:
    "*near *far *nearfar *clip* *clipping* aspect aspectratio aabb* *scenescale *bounds *sceneunit fromna keepcolmapcoords appliedscale autoscale* *overlap* integrations",
  photo:
    "*sharpness* *blur* *exposure* iso* *gain* *whitebalance* *lux* *temperature *fstop* *focusdistance exif* *grain *velocity* *acceleration* *brightness* *ambient* *intensity lensposition spec* focallengthmetric focallength35* dfov diagonalfov",
  calibration:
    "*reprojection* rms ret *error* *errors board* square* pattern* flags nframes nrofframes imagepoints gridpoints objectpoints *covariance* *std *stddev estimate* perview* perframe* metricradius *lookuptablesize lensdistortioncenter inverselensdistortionlookuptable pixelsize dw dh typeid dt rows cols",
  sensors:
    "*imu* *accel* *gyro* *magneto* *noise* *walk *housing* *battery* *usec *bpp *bytes* rgb bgr camerafisheye* fisheyepoly* fisheyemax* fisheyenominal* fisheyeoptical*",
  programs:
    "viewer* mframes* newwidth newheight orbextractor* system* loop* mapping tracking training dataset optimization objects object* exported* marching* rendering *mesh *confidence* centerdepth",
} as const;

const globs = (keys: string) =>
  new RegExp(`^(${keys.replaceAll(" ", "|").replaceAll("*", ".*").replaceAll("?", "\\d")})$`);

const otherKeys = globs(
  Object.entries(others)
    .map(([, keys]) => keys)
    .join(" "),
);
const otherLists = globs(others.lists);

const byKey = new Map(keyTable.flatMap(([meaning, keys]) => keys.split(" ").map((key) => [key, meaning] as const)));

/** The name of one of several cameras in a key. */
const role = /depth|colou?r|rgb|infra\w*?(?:red)?|left|right|^cam(?:era)?[0-9](?=[a-z])/;

const plain = (key: string) => key.toLowerCase().replace(/[^a-z0-9]/g, "");

/** What a key that is not in the table says by the words in it. */
function likeness(name: string, value: unknown): Meaning | undefined {
  if (typeof value === "string") return /model|type|lens|projection/.test(name) ? "model" : undefined;
  if (typeof value !== "number") return /distort|^dist(?!an)|coeffs?$/.test(name) ? "distortion" : undefined;
  return /depth/.test(name) && /scale|factor|unit|divi|multipl/.test(name) ? "depthScale" : undefined;
}

const withoutCamera = (name: string) => name.replace(/^cam(era)?/, "");

/** Whether the value of a key has a bearing on intrinsics only if it is one number. */
const isOther = (name: string, value: unknown): boolean =>
  otherKeys.test(name) && !(typeof value === "number" && otherLists.test(name));

/** What a key says, and of which of several cameras, if it says so; `undefined` for an unknown key. */
export function meaningOf(key: string, value: unknown): { meaning: Meaning; camera?: string } | undefined {
  // Our own is metres per unit; that of others may be anything.
  if (key === "depthScale") return { meaning: "metresPerUnit" };
  const name = plain(key);
  const meaning = byKey.get(name) ?? byKey.get(withoutCamera(name));
  if (meaning !== undefined) return { meaning };
  const camera = role.exec(name)?.[0];
  const ofCamera = camera === undefined ? undefined : byKey.get(withoutCamera(name.replace(camera, "")));
  if (ofCamera !== undefined) return { meaning: ofCamera, camera: camera as string };
  if (isOther(name, value) || isOther(withoutCamera(name), value)) return { meaning: "other" };
  const similar = likeness(name, value);
  return similar === undefined ? undefined : { meaning: similar };
}
