//! What is written reads back to the bit; whatever else is in a file is an error that names it.

use exr::image::{Encoding, Image, Layer};
use exr::meta::header::LayerAttributes;
use half::f16;
use proptest::prelude::*;

use super::*;

const SIZE: UVec2 = UVec2::new(20, 18);
const PIXELS: usize = 20 * 18;

/// A frame whose every sample differs from its neighbours.
fn frame() -> Frame {
    let mut surfaces = Surfaces::empty(SIZE.x, SIZE.y);
    for index in 0..PIXELS - 1 {
        surfaces.depth_m[index] = 1.0 + index as f32 * 0.37;
        surfaces.id[index] = (index as u32 * 7) % 2000;
    }
    let rgb =
        (0..PIXELS).map(|index| [0.1, 0.2, 0.3].map(|base| f16::from_f32(base * index as f32))).collect();
    Frame { surfaces, rgb }
}

fn path() -> &'static Path {
    Path::new("cam00/0000.exr")
}

fn channels() -> Vec<AnyChannel<FlatSamples>> {
    let colour = || FlatSamples::F16(vec![f16::ONE; PIXELS]);
    vec![
        AnyChannel::new("B", colour()),
        AnyChannel::new("G", colour()),
        AnyChannel::new("R", colour()),
        AnyChannel::new("Z", FlatSamples::F32(vec![1.0; PIXELS])),
        AnyChannel::new("id", FlatSamples::U32(vec![0; PIXELS])),
    ]
}

/// The message of the refusal.
fn refusal(bytes: &[u8]) -> (&'static str, String) {
    let error = decode_frame(path(), bytes, SIZE).unwrap_err();
    (error.code(), error.to_string())
}

#[test]
fn a_frame_reads_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cam00/0000.exr");
    write_frame(&path, &frame()).unwrap();
    assert_eq!(read_frame(&path, SIZE).unwrap(), frame());
    assert_eq!(read_surfaces(&path, SIZE).unwrap(), frame().surfaces);
}

#[test]
fn the_same_frame_gives_the_same_bytes() {
    assert_eq!(encode_frame(path(), &frame()).unwrap(), encode_frame(path(), &frame()).unwrap());
}

#[test]
fn a_missing_file_is_named() {
    let error = read_frame(Path::new("nowhere/0000.exr"), SIZE).unwrap_err();
    assert_eq!(error.code(), "L4D104");
    assert!(error.to_string().starts_with("nowhere/0000.exr: cannot open"), "{error}");
}

#[test]
fn lossy_and_other_compressions_are_refused() {
    let dwaa = encode_channels(channels(), SIZE, Compression::DWAA(None)).unwrap();
    let (code, message) = refusal(&dwaa);
    assert_eq!(code, "L4D105");
    assert!(message.contains("attribute `compression`") && message.contains("loses data"), "{message}");
    for other in [Compression::PIZ, Compression::Uncompressed, Compression::ZIP1] {
        assert_eq!(refusal(&encode_channels(channels(), SIZE, other).unwrap()).0, "L4D105");
    }
}

#[test]
fn channels_of_other_names_or_types_are_refused() {
    let mut float_ids = channels();
    float_ids[4] = AnyChannel::new("id", FlatSamples::F32(vec![0.0; PIXELS]));
    let (code, message) = refusal(&encode_channels(float_ids, SIZE, Compression::ZIP16).unwrap());
    assert_eq!(code, "L4D105");
    assert!(message.contains("are B half, G half, R half, Z float, id float, but must be"), "{message}");
    let mut without_depth = channels();
    without_depth.remove(3);
    assert_eq!(refusal(&encode_channels(without_depth, SIZE, Compression::ZIP16).unwrap()).0, "L4D105");
    let mut with_alpha = channels();
    with_alpha.push(AnyChannel::new("A", FlatSamples::F16(vec![f16::ONE; PIXELS])));
    assert_eq!(refusal(&encode_channels(with_alpha, SIZE, Compression::ZIP16).unwrap()).0, "L4D105");
}

#[test]
fn who_needs_no_ids_can_do_without_them_and_nothing_else() {
    let encode = |channels| encode_channels(channels, SIZE, Compression::ZIP16).unwrap();
    let whole = encode_frame(path(), &frame()).unwrap();
    assert_eq!(decode_seen(path(), &whole, SIZE).unwrap(), frame());

    let mut without_ids = channels();
    without_ids.pop();
    let bytes = encode(without_ids.clone());
    let seen = decode_seen(path(), &bytes, SIZE).unwrap();
    assert_eq!((seen.surfaces.id, seen.surfaces.depth_m), (vec![0; PIXELS], vec![1.0; PIXELS]));
    assert_eq!(seen.rgb, vec![[f16::ONE; 3]; PIXELS]);
    assert_eq!(refusal(&bytes).0, "L4D105");
    for length in 0..bytes.len() {
        assert_eq!(decode_seen(path(), &bytes[..length], SIZE).unwrap_err().code(), "L4D104");
    }

    let mut without_depth = without_ids;
    without_depth.pop();
    let bytes = encode(without_depth);
    assert_eq!(decode_seen(path(), &bytes, SIZE).unwrap_err().code(), "L4D105");
    assert_eq!(decode_colour(path(), &bytes, SIZE).unwrap(), vec![[f16::ONE; 3]; PIXELS]);
}

#[test]
fn several_parts_are_refused() {
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::FAST_LOSSLESS };
    let layer = |name: &str| {
        let attributes = LayerAttributes::named(name);
        Layer::new((20, 18), attributes, encoding, AnyChannels::sort(channels().into()))
    };
    let mut bytes = Cursor::new(Vec::new());
    let attributes = exr::meta::header::ImageAttributes::with_size((20, 18));
    let image = Image::from_layers(attributes, exr::image::Layers::from([layer("a"), layer("b")].as_slice()));
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    let (code, message) = refusal(&bytes.into_inner());
    assert_eq!(code, "L4D105");
    assert!(message.contains("has 2 parts"), "{message}");
}

#[test]
fn another_size_is_refused_before_room_is_made_for_it() {
    let bytes = encode_frame(path(), &frame()).unwrap();
    let error = decode_frame(path(), &bytes, UVec2::new(256, 192)).unwrap_err();
    assert_eq!(error.code(), "L4D106");
    assert!(error.to_string().contains("is 20x18 pixels, but 256x192 are expected"), "{error}");

    let mut hostile = bytes;
    for window in ["dataWindow", "displayWindow"] {
        set_window(&mut hostile, window, [0, 0, 99_999, 99_999]);
    }
    let (code, message) = refusal(&hostile);
    assert_eq!(code, "L4D106");
    assert!(message.contains("100000x100000"), "{message}");
}

#[test]
fn windows_that_differ_are_refused() {
    let mut bytes = encode_frame(path(), &frame()).unwrap();
    set_window(&mut bytes, "displayWindow", [0, 0, 30, 30]);
    let (code, message) = refusal(&bytes);
    assert_eq!(code, "L4D105");
    assert!(message.contains("displayWindow"), "{message}");
}

/// Overwrites `xMin yMin xMax yMax` of a window attribute.
fn set_window(bytes: &mut [u8], name: &str, window: [i32; 4]) {
    let tag = format!("{name}\0box2i\0");
    let start = bytes.windows(tag.len()).position(|part| part == tag.as_bytes()).unwrap() + tag.len() + 4;
    for (slot, value) in bytes[start..start + 16].chunks_exact_mut(4).zip(window) {
        slot.copy_from_slice(&value.to_le_bytes());
    }
}

#[test]
fn values_that_cannot_be_are_refused() {
    let spoilt = |change: fn(&mut Frame)| {
        let mut frame = frame();
        change(&mut frame);
        refusal(&encode_frame(path(), &frame).unwrap())
    };
    let (code, message) = spoilt(|frame| frame.surfaces.depth_m[41] = f32::NAN);
    assert_eq!(code, "L4D107");
    assert!(message.contains("channel `Z`, column 1, row 2: depth is NaN m"), "{message}");
    assert_eq!(spoilt(|frame| frame.surfaces.id[PIXELS - 1] = 5).0, "L4D107");
    let (code, message) = spoilt(|frame| frame.rgb[20][1] = f16::INFINITY);
    assert_eq!(code, "L4D107");
    assert!(message.contains("channels `R G B`, row 1"), "{message}");
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = encode_frame(path(), &frame()).unwrap();
    for length in 0..bytes.len() {
        let (code, message) = refusal(&bytes[..length]);
        assert_eq!(code, "L4D104", "{length} bytes: {message}");
    }
}

/// Nothing is drawn in the last pixel.
fn depth() -> DepthMap {
    let mut depth = DepthMap::empty(SIZE.x, SIZE.y);
    for index in 0..PIXELS - 1 {
        depth.depth_m[index] = 1.0 + 0.37 * index as f32;
        depth.alpha[index] = f16::from_f32(index as f32 / 400.0);
        depth.near_m[index] = f16::from_f32(0.9 + 0.37 * index as f32);
        depth.far_m[index] = f16::from_f32(1.1 + 0.37 * index as f32);
    }
    depth
}

#[test]
fn a_drawn_depth_reads_back_to_the_bit_and_nothing_else_is_one() {
    let bytes = encode_depth(path(), &depth()).unwrap();
    assert_eq!(decode_depth(path(), &bytes, SIZE).unwrap(), depth());
    assert_eq!(bytes, encode_depth(path(), &depth()).unwrap());
    let error = decode_depth(path(), &bytes, UVec2::new(256, 192)).unwrap_err().to_string();
    assert!(error.contains("is 20x18 pixels, but 256x192 are expected"), "{error}");
    let frame = encode_frame(path(), &frame()).unwrap();
    let error = decode_depth(path(), &frame, SIZE).unwrap_err().to_string();
    assert!(error.contains("but must be A half, Z float, far.Z half, near.Z half"), "{error}");
    for length in 0..bytes.len() {
        assert!(decode_depth(path(), &bytes[..length], SIZE).is_err(), "{length} bytes passed");
    }
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(
        changes in prop::collection::vec((0usize..1_000_000, any::<u8>()), 1..12)
    ) {
        let mut bytes = encode_frame(path(), &frame()).unwrap();
        let length = bytes.len();
        for &(place, value) in &changes {
            bytes[place % length] = value;
        }
        // An error or a frame of the right size; nothing else can come back.
        if let Ok(frame) = decode_frame(path(), &bytes, SIZE) {
            prop_assert_eq!(frame.rgb.len(), PIXELS);
        }
        let mut bytes = encode_depth(path(), &depth()).unwrap();
        let length = bytes.len();
        for (place, value) in changes {
            bytes[place % length] = value;
        }
        if let Ok(depth) = decode_depth(path(), &bytes, SIZE) {
            prop_assert_eq!(depth.depth_m.len(), PIXELS);
        }
    }
}
