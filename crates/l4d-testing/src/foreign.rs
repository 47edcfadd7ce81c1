//! Files as NumPy and PyTorch write them.

/// A `.npy` of float32 in rows, as `numpy.save` writes it.
pub fn npy(shape: &[usize], data: &[f32]) -> Vec<u8> {
    npy_of("<f4", shape, data.iter().copied().flat_map(f32::to_le_bytes))
}

/// A `.npy` of texts, as `numpy.save` writes it.
pub fn npy_texts(texts: &[&str]) -> Vec<u8> {
    let length = texts.iter().map(|text| text.chars().count()).max().unwrap_or(1).max(1);
    let codes = texts
        .iter()
        .flat_map(|text| text.chars().map(u32::from).chain(std::iter::repeat(0)).take(length))
        .flat_map(u32::to_le_bytes);
    npy_of(&format!("<U{length}"), &[texts.len()], codes)
}

fn npy_of(kind: &str, shape: &[usize], data: impl Iterator<Item = u8>) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if lengths.len() == 1 { "," } else { "" };
    let lengths = lengths.join(", ");
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({lengths}{comma}), }}");
    // What precedes the numbers fills whole blocks of 64 bytes.
    let length = (header.len() + 11).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((length as u16).to_le_bytes());
    file.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    file.extend(data);
    file
}

/// The archive of these arrays, as `numpy.savez` writes it.
pub fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    l4d_formats::arrays::encode_npz("made up".as_ref(), arrays).unwrap()
}

/// A state dict as torch saves it.
pub fn pth(tensors: &[(&str, &[usize], Vec<f32>)]) -> Vec<u8> {
    let text = |text: &str| [b"X", &(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let int = |number: usize| [b"J", &(number as u32).to_le_bytes()[..]].concat();
    let ints = |numbers: &[usize]| {
        [b"(".to_vec(), numbers.iter().flat_map(|&number| int(number)).collect(), b"t".to_vec()].concat()
    };
    let mut pickle = b"\x80\x02}(".to_vec();
    let mut entries = Vec::new();
    for (key, (name, shape, data)) in tensors.iter().enumerate() {
        let strides: Vec<usize> = (1..=shape.len()).map(|axis| shape[axis..].iter().product()).collect();
        pickle.extend(text(name));
        pickle.extend(b"ctorch._utils\n_rebuild_tensor_v2\n((");
        pickle.extend(text("storage"));
        pickle.extend(b"ctorch\nFloatStorage\n");
        pickle.extend([text(&key.to_string()), text("cpu"), int(data.len())].concat());
        pickle.extend(b"tQK\0");
        pickle.extend([ints(shape), ints(&strides)].concat());
        pickle.extend(b"\x89ccollections\nOrderedDict\n)RtR");
        let bytes: Vec<u8> = data.iter().flat_map(|value| value.to_le_bytes()).collect();
        entries.push((format!("x/data/{key}"), bytes));
    }
    pickle.extend(b"u.");
    entries.insert(0, ("x/data.pkl".to_owned(), pickle));
    entries.push(("x/version".to_owned(), b"3\n".to_vec()));
    l4d_formats::zip::encode(entries.iter().map(|(name, bytes)| (name, bytes.as_slice()))).unwrap()
}
