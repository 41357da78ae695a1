//! Warnings.

use serde::Serialize;

/// A condition that the caller should know about; the result stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct Warning {
    /// The kind of warning, stable across releases.
    pub code: WarningCode,
    /// The fault and its remedy.
    pub message: String,
}

/// The kinds of warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[non_exhaustive]
pub enum WarningCode {
    /// Depths so large that they look like millimetres passed as metres.
    DepthLooksLikeMillimetres,
    /// Depths so small that they look like metres taken as millimetres.
    DepthLooksTooSmall,
    /// The surroundings of the object are nearer than it: near may be large in this depth map.
    DepthLooksInverted,
    /// The depth in the mask continues the plane around it, and the pose is in doubt: the object may be transparent. `align` of the
    /// package looks at it.
    DepthLooksLikeBackground,
    /// The depth map spans exactly the range of a normalised one: its values are relative.
    DepthLooksNormalised,
    /// The values of the depth map are like those of a code, and no lengths. The package looks at them.
    DepthLooksCoded,
    /// The depth in the mask has readings far from all their neighbours, and the pose is in doubt. `align` of the package looks at it.
    DepthHasSpeckle,
    /// The mask covers the whole image: it is probably inverted, or no mask.
    MaskCoversImage,
    /// The mask covers most of the image's border: it is probably that of the background.
    MaskLooksInverted,
    /// The mask is a map of labels, all of which are read as the object, and the pose is in doubt. The package looks at it.
    MaskHasLabels,
    /// The mask touches the image border: part of the object is outside the view.
    MaskTouchesBorder,
    /// Less than half of the mask has a depth reading.
    SparseDepth,
    /// The scale was held at a bound of `scale` or of the guard.
    ScaleClamped,
    /// The scale fell below 0.3 of the initial scale.
    ScaleCollapsed,
    /// The refinement ended before it converged.
    NotConverged,
    /// Even the best pose explains the observation poorly: the mesh may be of another object.
    MeshDoubtful,
    /// The pose is in doubt, and the mirror image of the mesh fits far better. `align` of the package looks at it.
    MeshLooksMirrored,
    /// The mesh file places several copies of one mesh, all of which are read as one object. The package's mesh reader warns of it.
    MeshHoldsCopies,
    /// The photo contradicts the textures of the mesh, and agrees with them upside down. `align` of the package looks at it.
    TextureLooksFlipped,
    /// Parts of the mesh are not of the object, and do not count: floating ones, inner shells, a ground plate.
    MeshPartsLeftOut,
    /// A view contradicts the others and does not count (`alignViews`).
    ViewContradicts,
    /// A view shows too little where the object should be, and does not count (`alignViews`).
    ViewShowsNothing,
    /// The camera file has lens distortion, which the pinhole model leaves out. The package's camera reader warns of
    /// it.
    CameraNotPinhole,
    /// The principal point does not fit the image: the intrinsics may be those of an image of another size. The package's camera
    /// reader warns of it.
    CameraDoubtful,
    /// The object would be unusually large or near, and the unit of the depth was assumed: the pose fits the image, but sizes and
    /// distances may be wrong by a factor.
    SizeDoubtful,
    /// No camera was given, and neither the depth file nor the photo states a focal length: it was estimated from the object.
    /// The package's camera reader warns of it.
    FocalLengthUnknown,
    /// A file states something that its reader does not know and did not use. The package's readers warn of it.
    ContentNotRead,
    /// The colours of the mesh file cannot be read, such as a texture in an unsupported format: the mesh is aligned by its
    /// shape alone. The package's mesh reader warns of it.
    ColorsNotRead,
}
