//! EXIF data of photos (Exif 2.32, CIPA DC-008).

use exif::{Error as ExifError, Exif as Fields, In, Reader, Tag, Value};

use crate::orientation::Orientation;

/// Millimetres of the units of `FocalPlaneResolutionUnit`: 2 is the inch, its default, 3 the centimetre; cameras also
/// write 4 for millimetres and 5 for micrometres.
const UNIT_MM: [(u32, f64); 4] = [(2, 25.4), (3, 10.0), (4, 1.0), (5, 0.001)];

/// The camera in the EXIF data of a photo. Numbers that are not above 0 mean "unknown" and are left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Exif {
    /// The focal length of a lens with the same diagonal field of view on a frame of 36 × 24 mm, in mm.
    pub focal_length_35mm: Option<f64>,
    /// The focal length of the lens, in mm.
    pub focal_length_mm: Option<f64>,
    /// The width of the sensor as far as the original image shows it, in mm.
    pub sensor_width_mm: Option<f64>,
    /// How many times the image was enlarged by the camera.
    pub digital_zoom: Option<f64>,
    /// The camera's maker.
    pub make: Option<String>,
    /// The camera's model.
    pub model: Option<String>,
    /// 1 to 8, see [`Orientation`]; 1 where the data state none.
    pub orientation: Orientation,
    /// Width of the original image as it was stored, in pixels.
    pub width: Option<u32>,
    /// Height of the original image as it was stored, in pixels.
    pub height: Option<u32>,
}

/// The fields that can be read.
fn fields(tiff: Vec<u8>) -> Option<Fields> {
    match Reader::new().continue_on_error(true).read_raw(tiff) {
        Ok(fields) => Some(fields),
        Err(ExifError::PartialResult(partial)) => Some(partial.into_inner().0),
        Err(_) => None,
    }
}

/// The orientation in EXIF data, from their TIFF header; upright where they state none.
pub(crate) fn orientation(tiff: &[u8]) -> Orientation {
    fields(tiff.to_vec()).as_ref().map(orientation_of).unwrap_or_default()
}

fn orientation_of(fields: &Fields) -> Orientation {
    whole(fields, Tag::Orientation).and_then(Orientation::new).unwrap_or_default()
}

impl Exif {
    /// The fields of EXIF data, from their TIFF header. Those that are damaged or missing are left out.
    pub(crate) fn parse(tiff: Vec<u8>) -> Self {
        let Some(fields) = &fields(tiff) else { return Self::default() };
        let number = |tag| number(fields, tag);
        let width = whole(fields, Tag::PixelXDimension);
        let unit = whole(fields, Tag::FocalPlaneResolutionUnit).unwrap_or(2);
        let unit_mm = UNIT_MM.iter().find(|&&(code, _)| code == unit).map(|&(_, mm)| mm);
        let pixels_per_unit = number(Tag::FocalPlaneXResolution);
        let sensor_width_mm = match (width, pixels_per_unit, unit_mm) {
            (Some(width), Some(per_unit), Some(mm)) => Some(f64::from(width) / per_unit * mm),
            _ => None,
        };
        Self {
            focal_length_35mm: number(Tag::FocalLengthIn35mmFilm),
            focal_length_mm: number(Tag::FocalLength),
            sensor_width_mm,
            digital_zoom: number(Tag::DigitalZoomRatio),
            make: text(fields, Tag::Make),
            model: text(fields, Tag::Model),
            orientation: orientation_of(fields),
            width,
            height: whole(fields, Tag::PixelYDimension),
        }
    }
}

fn value(fields: &Fields, tag: Tag) -> Option<&Value> {
    // Of the photo, not of its thumbnail.
    Some(&fields.get_field(tag, In::PRIMARY)?.value)
}

/// A whole number above 0.
fn whole(fields: &Fields, tag: Tag) -> Option<u32> {
    value(fields, tag)?.get_uint(0).filter(|&number| number > 0)
}

/// A finite number above 0.
fn number(fields: &Fields, tag: Tag) -> Option<f64> {
    let number = match value(fields, tag)? {
        Value::Rational(values) => values.first()?.to_f64(),
        Value::SRational(values) => values.first()?.to_f64(),
        Value::Float(values) => f64::from(*values.first()?),
        Value::Double(values) => *values.first()?,
        other => f64::from(other.get_uint(0)?),
    };
    (number.is_finite() && number > 0.0).then_some(number)
}

fn text(fields: &Fields, tag: Tag) -> Option<String> {
    let Value::Ascii(lines) = value(fields, tag)? else { return None };
    let text = String::from_utf8_lossy(lines.first()?).trim().to_owned();
    (!text.is_empty()).then_some(text)
}
