/** The keys of camera files: one table, from which they are read. */

/** The meaning of a key. */
export type Meaning =
  | ("fx" | "fy" | "cx" | "cy" | "focal" | "center" | "matrix" | "projection" | "skew" | "focalUncertainty")
  | ("width" | "height" | "size" | "shape" | "region" | "binningX" | "binningY")
  | ("fovX" | "fovY" | "fov" | "apertureX" | "apertureY" | "aperture" | "fit")
  | ("metresPerUnit" | "unitsPerMetre" | "depthScale" | "scale" | "unit")
  | ("distortion" | "coefficient" | "model" | "up");

/**
 * Meaning, keys, programs that write them. Keys are in lower case, without other signs than letters and digits; {@link meaningOf}
 * also knows them behind `camera`, and beside the name of one of several cameras.
 */
const table = `
fx | fx flx focalx focallengthx fu fxpx alphau | RealSense, Polycam, nerfstudio, instant-ngp, ORB-SLAM, ZED, Replica, DOPE
fy | fy fly focaly focallengthy fv fypx alphav | RealSense, Polycam, nerfstudio, instant-ngp, ORB-SLAM, ZED, Replica, DOPE
cx | cx ppx u0 cu mx principalpointx px x0 ox cxpx centerx | RealSense, nerfstudio, ScanNet
cy | cy ppy v0 cv my principalpointy py y0 oy cypx centery | RealSense, nerfstudio, ScanNet
focal | f focal focals focallength focallengths | DUSt3R, Unity, MATLAB, Isaac Sim, Metashape
focal | focalpx focallengthpx fpx fc lens focallengthmm | Depth Pro, Blender
focalUncertainty | focaluncertainty |
center | pp principalpoint principalpoints opticalcenter cc | DUSt3R, Unity, MATLAB
matrix | k kmat kmatrix camk camerak intr intrinsic intrinsics mtx cammat | BOP, ROS, Record3D, ARKit, Kalibr, HOPE, VGGT, MoGe
matrix | intrinsicmatrix intrinsicsmatrix intrinsicmat cameramatrix | Open3D, OpenCV, DepthAI, MATLAB
matrix | camintrinsic camintrinsics cameraintrinsic cameraintrinsics mcalibrationintrinsic | FoundationPose, ScanNet
skew | skew s skx | NDDS, MATLAB
width | w width imagewidth imgwidth resx resolutionx resolutionwidth mwidth | RealSense, Polycam, ROS, Open3D, Record3D, NDDS
height | h height imageheight imgheight resy resolutiony resolutionheight mheight | RealSense, Polycam, ROS, Open3D, Record3D, NDDS
size | size imagesize imgsize resolution imageresolution | Kalibr, ZED, Unity
size | renderproductresolution imagedimensions imagedims referencedimensions intrinsicmatrixreferencedimensions | Isaac Sim, ARCore, ARKit
shape | shape imageshape imgshape hw imagehw |
region | roi | ROS
binningX | binningx | ROS
binningY | binningy | ROS
fovX | fovx fovxdeg fovxrad hfov horizontalfov fovh xfov | MoGe, Habitat
fovX | fovhorizontal horizontalfieldofview cameraanglex | nerfstudio
fovY | fovy fovydeg fovyrad vfov verticalfov fovv yfov | MuJoCo, MoGe, glTF
fovY | fovvertical verticalfieldofview cameraangley | nerfstudio
fov | fov fovdeg fovrad fieldofview | CARLA, three.js, Unity
apertureX | aperturex horizontalaperture sensorwidth filmwidth | USD, Blender
apertureY | aperturey verticalaperture sensorheight filmheight | USD, Blender
aperture | aperture sensorsize | Isaac Sim
fit | sensorfit gatefit | Blender, Unity
metresPerUnit | depthunitscalefactor integerdepthscale depthtometers depthtometres | nerfstudio, NeRFCapture
unitsPerMetre | factordepth depthfactor pngdepthscale depthmapfactor rgbddepthmapfactor | GraspNet, YCB-Video, NICE-SLAM, ORB-SLAM
unitsPerMetre | depthscalingfactor depthshift mshift depthdivisor unitspermeter unitspermetre | ScanNet
depthScale | depthscale depthscalefactor depthunitscale depthmultiplier depthscaling depthprecision | BOP, RealSense, Open3D
scale | scale scalingfactor factor | Replica, TUM
unit | depthunit depthunits | RealSense
distortion | d dist disto distortion kc coef coeffs coefficients | ROS, RealSense, ZED
distortion | radialdistortion tangentialdistortion lensdistortionlookuptable | MATLAB, ARKit
coefficient | k1 k2 k3 k4 k5 k6 p1 p2 | nerfstudio, ORB-SLAM, ZED, Azure Kinect
model | model cameramodel distortionmodel distortiontype lensmodel cameratype type | nerfstudio, ROS, Kalibr, ORB-SLAM
model | projection projectiontype isfisheye fisheye fisheyemodel | nerfstudio, OpenCV
up | gravity gravityvector up cameraup updirection | ARKit
`;

/** The rows of the table. */
export const keyTable = table
  .trim()
  .split("\n")
  .map((row) => {
    const [meaning = "", keys = "", by = ""] = row.split(/ *\| */);
    return { meaning: meaning as Meaning, keys: keys.split(" "), by: by.split(", ") };
  });

/**
 * What else the files of these programs hold, and what says nothing about intrinsics or the unit of depth; `*` is any text, `?` a
 * digit. Of `lists`, a single number is not known: it may turn the image.
 */
const others = {
  poses: `*extrinsic* *pose *poses pose* *transform* *quaternion* *w2c* *c2w* *m2c* *world* *viewmatrix *lookat r t p rt q
    qvec tvec rvec rvecs tvecs t?? tic tbs tx ty tz qw qx qy qz tcam* tcn* tbc* tbody* location* position* *translation*
    *rectif* *projectionmatrix *homography* *essentialmatrix *fundamentalmatrix elev viewlevel sphere* r?? r?rect rrect* srect* tr
    axisalign* trvelo* trimu* trcam*`,
  lists: "rotation* orientation* projection cameraprojection offset center",
  identity: `*time* *stamp* *serial* *version* *id *ids *uuid *name* *index *idx *count *number num* *date *fps* framerate
    rate* seq header frame device* board* product* batch* hardware* misc* unit units *socket mode *path *neighbors *quality
    *keyframe*`,
  stereo: "*baseline* bf *thdepth doffs ndisp vmin vmax isint disp* stereo* *stereo",
  scene: `*near *far *nearfar *clip* aspect aspectratio aabb* *scenescale *bounds *sceneunit fromna keepcolmapcoords
    appliedscale autoscale* *overlap* integrations`,
  photo: `*sharpness* *blur* *exposure* iso* *gain* *whitebalance* *lux* *temperature *fstop* *focusdistance exif* *grain
    *velocity* *acceleration* *brightness* *ambient* *intensity lensposition spec* focallengthmetric focallength35* dfov
    diagonalfov`,
  calibration: `*reprojection* rms ret *error* square* pattern* flags nframes nrofframes imagepoints gridpoints objectpoints
    *covariance* *std *stddev estimate* perview* perframe* metricradius *lookuptablesize lensdistortioncenter
    inverselensdistortionlookuptable pixelsize corner* dw dh typeid dt rows cols`,
  sensors: `*imu* *accel* *gyro* *magneto* *noise* *walk *housing* *battery* *usec *bpp *bytes* rgb bgr camerafisheye*
    fisheyepoly* fisheyemax* fisheyenominal* fisheyeoptical*`,
  programs: `viewer* mframes* newwidth newheight orbextractor* system* loop* mapping tracking training optimization
    pcddownsample* pointsize optparams modelparams pipelineparams
    objects object* exported* marching* rendering *mesh *confidence* centerdepth`,
} as const;

const globs = (keys: string) =>
  new RegExp(`^(${keys.trim().replace(/\s+/g, "|").replaceAll("*", ".*").replaceAll("?", "\\d")})$`);

const otherKeys = globs(Object.values(others).join(" "));
const otherLists = globs(others.lists);

const byKey = new Map(keyTable.flatMap(({ meaning, keys }) => keys.map((key) => [key, meaning] as const)));

/** The name of one of several cameras in a key; KITTI's have two digits. */
const role = /depth|colou?r|rgb|infra\w*?(?:red)?|left|right|^cam(?:era)?[0-9](?=[a-z])|0[0-9]$/;

/** Matrices and distortion of the two cameras of OpenCV's stereo. */
const numbered = /^([kmd])([12])$/;

const withoutCamera = (name: string) => name.replace(/^cam(era)?/, "");

const plain = (key: string) => key.toLowerCase().replace(/[^a-z0-9]/g, "");

/** Whether a key that is not in the table has no bearing on intrinsics. */
export function isOther(key: string, value: unknown): boolean {
  const isNumber = typeof value === "number";
  const name = plain(key);
  return [name, withoutCamera(name)].some((one) => otherKeys.test(one) && !(isNumber && otherLists.test(one)));
}

/** The meaning of a key that is not in the table, by the words in it. */
function likeness(name: string, value: unknown): Meaning | undefined {
  if (typeof value === "string") return /model|type|lens|projection/.test(name) ? "model" : undefined;
  if (typeof value !== "number") return /distort|^dist(?!an)|coeffs?$/.test(name) ? "distortion" : undefined;
  return /depth/.test(name) && /scale|factor|unit|divi|multipl/.test(name) ? "depthScale" : undefined;
}

/** The meaning of a key, and which of several cameras it is about, if it names one. */
interface KeyMeaning {
  meaning: Meaning;
  camera?: string;
}

/** The keys that were looked up: files of many images have the same ones again and again. */
const known = new Map<string, KeyMeaning | undefined>();
const MAX_KNOWN = 1000;

/** The meaning of a key; `undefined` for an unknown one. */
export function meaningOf(key: string, value: unknown): KeyMeaning | undefined {
  const place = `${Array.isArray(value) ? "list" : typeof value} ${key}`;
  if (known.has(place)) return known.get(place);
  const meaning = lookedUp(key, value);
  if (known.size < MAX_KNOWN && key.length < 100) known.set(place, meaning);
  return meaning;
}

/** The meaning of a key by the table, the names of cameras, and the words in it. */
function lookedUp(key: string, value: unknown): KeyMeaning | undefined {
  // Our own is metres per unit; that of others may be anything.
  if (key === "depthScale") return { meaning: "metresPerUnit" };
  const name = plain(key);
  const [, letter, digit] = (Array.isArray(value) && numbered.exec(name)) || [];
  if (letter !== undefined) return { meaning: letter === "d" ? "distortion" : "matrix", camera: `camera${digit}` };
  const meaning = byKey.get(name) ?? byKey.get(withoutCamera(name));
  if (meaning !== undefined) return { meaning };
  const camera = role.exec(name)?.[0];
  const ofCamera = camera === undefined ? undefined : byKey.get(withoutCamera(name.replace(camera, "")));
  if (camera !== undefined && ofCamera !== undefined) return { meaning: ofCamera, camera };
  const similar = likeness(name, value);
  return similar === undefined || isOther(key, value) ? undefined : { meaning: similar };
}
