//! Pickles and archives that mean harm.

use l4d_formats::pickle::{self, Saved};
use proptest::prelude::*;

use super::{bytes, entries, fixture};

/// A stored archive.
pub(crate) fn zip(entries: &[(&str, &[u8])]) -> Vec<u8> {
    l4d_formats::zip::encode(entries.iter().copied()).unwrap()
}

/// Why a pickle is refused; `storage` is `data/0`.
fn refusal(pickle: &[u8], storage: &[u8]) -> String {
    let file = zip(&[("x/data.pkl", pickle), ("x/data/0", storage)]);
    pickle::decode(&file).expect_err("must be refused").to_string()
}

/// The opcodes of a tensor over `data/0`.
fn tensor(class: &str, claimed: u8, offset: &[u8], shape: &[u8], strides: &[u8]) -> Vec<u8> {
    [
        b"ctorch._utils\n_rebuild_tensor_v2\n((X\x07\0\0\0storagectorch\n".as_slice(),
        class.as_bytes(),
        b"\nX\x01\0\0\x000X\x03\0\0\0cpuK",
        &[claimed],
        b"tQ",
        offset,
        shape,
        strides,
        b"\x89ccollections\nOrderedDict\n)RtR",
    ]
    .concat()
}

fn program(body: &[u8]) -> Vec<u8> {
    [b"\x80\x02", body, b"."].concat()
}

#[test]
fn files_that_python_would_obey_are_refused_by_the_name_they_call() {
    for (file, name) in [
        ("poison_system", "posix.system"),
        ("poison_eval", "__builtin__.eval"),
        ("poison_numpy", "numpy._core.multiarray._reconstruct"),
        ("poison_module", "torch.nn.modules.linear.Linear"),
        ("poison_partial", "functools.partial"),
        ("poison_sparse", "torch._utils._rebuild_sparse_tensor"),
    ] {
        let error = pickle::read_tensor(&fixture(&format!("pth/{file}.pth"))).unwrap_err();
        assert!(
            error
                .to_string()
                .contains(&format!("names `{name}`, which is no part of a tensor; nothing was executed")),
            "{error}"
        );
        assert!(error.hint().contains("state_dict()"), "{error:?}");
    }
    let scalar = pickle::read_state_dict(&fixture("pth/poison_scalar.pth")).unwrap_err().to_string();
    assert!(scalar.contains("top level: is a tuple, but a tensor or a dict"), "{scalar}");
    let legacy = pickle::read_tensor(&fixture("pth/legacy.pth")).unwrap_err().to_string();
    assert!(legacy.ends_with("first bytes: are those of a torch older than 1.6"), "{legacy}");
    let script = pickle::read_tensor(&fixture("pth/script.pth")).unwrap_err().to_string();
    assert!(script.ends_with("archive: is a TorchScript program, not a dict of tensors"), "{script}");
}

#[test]
fn every_way_to_name_or_call_something_is_closed() {
    let none = |pickle: &[u8]| refusal(&program(pickle), &[]);
    assert_eq!(
        none(b"cos\nsystem\n"),
        "data.pkl, byte 2: names `os.system`, which is no part of a tensor; nothing was executed"
    );
    assert!(none(b"\x8c\x02os\x8c\x06system\x93").contains("names `os.system`"));
    assert!(none(b"(X\x02\0\0\0idios\nsystem\n").contains("names `os.system`"));
    assert!(none(b"cbuiltins\ngetattr\n").contains("names `builtins.getattr`"));
    assert!(none(b"ctorch\nload\n").contains("names `torch.load`"));
    assert!(none(b"ctorch.FloatStorage\nfrom_file\n").contains("names `torch.FloatStorage.from_file`"));
    assert!(none(b"c\x1b]0;gotcha\x07\nx\n").contains("names `\u{fffd}]0;gotcha\u{fffd}.x`"));
    assert!(none(b"ctorch\nFloatStorage\n)R").contains("calls a class in a way that tensors do not need"));
    assert!(none(b"ctorch\nFloatStorage\n)\x81").contains("opcode 0x81 is NEWOBJ"));
    assert!(none(b"ccollections\nOrderedDict\nK\x01\x85R").contains("calls a class in a way"));
    assert!(none(b"X\x01\0\0\0x)R").contains("calls a string; nothing was executed"));
    assert!(none(b"(ccollections\nOrderedDict\no").contains("OBJ"));
    assert!(none(b"\x82\x01").contains("EXT"));
    assert!(none(b"Psomething\n").contains("PERSID"));
    assert!(none(b"]}b").contains("sets the state of a list"));
    assert!(none(b"}X\x01\0\0\0xb").contains("sets the state of a dict"));
    assert!(none(b"X\x01\0\0\0xQ").contains("refers to something other than a storage"));
    assert!(none(b"ctorch\nFloatStorage\n").contains("is a class or function, but a tensor or a dict"));
    assert!(
        none(b"ctorch._utils\n_rebuild_parameter\n(K\x01\x89NtR")
            .contains("makes a parameter of something other than a tensor")
    );
    for (pickle, why) in [
        (b"\x80\x02".as_slice(), "ends within an opcode"),
        (b"\x80\x02.", "empty stack"),
        (b"\x80\x09.", "protocol 9"),
        (b"\x80\x02(.", "empty stack"),
        (b"\x80\x02K\x01(0.", "opcode 0x30"),
        (b"\x80\x02K\x01\x86.", "empty stack"),
        (b"\x80\x02K\x01(\x85.", "empty stack"),
        (b"\x80\x02t.", "no mark"),
        (b"\x80\x02h\x07.", "memo 7"),
        (b"\x80\x02q\x07.", "needs a value"),
        (b"\x80\x02X\xff\xff\xff\xff.", "ends within an opcode"),
        (b"\x80\x02X\x01\0\0\0\xff.", "no text"),
        (b"\x80\x02\x8a\x09\0\0\0\0\0\0\0\0\x01.", "more than 64 bits"),
        (b"\x80\x02}(K\x01u.", "key without a value"),
        (b"\x80\x02]K\x01K\x02s.", "sets items of a list"),
        (b"\x80\x02}K\x01a.", "appends to a dict"),
        (b"\x80\x02cos", "a name has no end"),
        (b"", "ends within an opcode"),
    ] {
        let found = refusal(pickle, &[]);
        assert!(found.contains(why), "{pickle:?}: {found}");
    }
}

#[test]
fn views_that_leave_their_storage_are_refused() {
    let floats = [0; 24];
    let refused = |pickle: Vec<u8>| refusal(&program(&pickle), &floats);
    let good = program(&tensor("FloatStorage", 6, b"K\0", b"K\x02K\x03\x86", b"K\x03K\x01\x86"));
    assert!(pickle::decode(&zip(&[("x/data.pkl", &good), ("x/data/0", &floats)])).is_ok());
    let beyond = "has 6 numbers, but a tensor starts at";
    assert!(
        refused(tensor("FloatStorage", 6, b"K\x01", b"K\x02K\x03\x86", b"K\x03K\x01\x86")).contains(beyond)
    );
    assert!(
        refused(tensor("FloatStorage", 6, b"K\0", b"K\x02K\x03\x86", b"K\x04K\x01\x86")).contains(beyond)
    );
    let huge = b"\x8a\x08\xff\xff\xff\xff\xff\xff\xff\x7f";
    let huge_stride = [huge.as_slice(), b"\x85"].concat();
    assert!(refused(tensor("FloatStorage", 6, b"K\0", b"K\x02\x85", &huge_stride)).contains(beyond));
    assert!(refused(tensor("FloatStorage", 6, huge, b"K\x02\x85", b"K\x01\x85")).contains(beyond));
    let negative = b"J\xff\xff\xff\xff";
    let negative_stride = [negative.as_slice(), b"\x85"].concat();
    assert!(
        refused(tensor("FloatStorage", 6, negative, b"K\x02\x85", b"K\x01\x85"))
            .contains("an offset that is no count")
    );
    assert!(
        refused(tensor("FloatStorage", 6, b"K\x05", b"K\x02\x85", &negative_stride))
            .contains("strides that are no tuple")
    );
    assert!(
        refused(tensor("FloatStorage", 6, b"K\0", &negative_stride, b"K\x01\x85"))
            .contains("a shape that is no tuple")
    );
    assert!(
        refused(tensor("FloatStorage", 6, b"K\0", b"K\x02\x85", b")")).contains("has 1 axes and 0 strides")
    );
    assert!(refused(tensor("FloatStorage", 6, b"K\0", b"]", b"]")).contains("a shape that is no tuple"));
}

#[test]
fn claims_of_size_are_held_against_the_file() {
    let floats = [0; 24];
    let refused = |pickle: Vec<u8>| refusal(&program(&pickle), &floats);
    let shape = |claimed: u8, class: &str| tensor(class, claimed, b"K\0", b"K\x01\x85", b"K\x01\x85");
    assert!(refused(shape(5, "FloatStorage")).contains("has 24 bytes, but the pickle claims 5 numbers of 4"));
    assert!(refused(shape(7, "FloatStorage")).contains("claims 7 numbers"));
    assert!(refused(shape(6, "DoubleStorage")).contains("claims 6 numbers of 8"));
    // A stride of zero makes a million numbers of one.
    let expanded = tensor("FloatStorage", 6, b"K\0", b"J\x40\x42\x0f\0\x85", b"K\0\x85");
    assert!(refused(expanded).contains("far more numbers than the file has room for"));
    let vast = b"\x8a\x08\xff\xff\xff\xff\xff\xff\xff\x7f";
    let vast_shape = [vast.as_slice(), vast, b"\x86"].concat();
    assert!(
        refused(tensor("FloatStorage", 6, b"K\0", &vast_shape, b"K\0K\0\x86"))
            .contains("fits into no machine")
    );
    let many_axes = [b"(".as_slice(), &b"K\x01".repeat(17), b"t"].concat();
    assert!(
        refused(tensor("FloatStorage", 6, b"K\0", &many_axes, &many_axes))
            .contains("a shape that is no tuple")
    );
    // The same tensor again and again, through the memo: each is as large as the storage.
    let entry = |name: u8| [b"X\x01\0\0\0".as_slice(), &[name], b"h\0"].concat();
    let entries: Vec<u8> = (b'A'..=b'z').flat_map(entry).collect();
    let hundred = tensor("FloatStorage", 6, b"K\0", b"K\x64\x85", b"K\0\x85");
    let again = [hundred.as_slice(), b"q\0}(", &entries, b"u"].concat();
    assert!(refused(again).contains("far more numbers"));
    let missing = zip(&[("x/data.pkl", &program(&shape(6, "FloatStorage")))]);
    assert_eq!(
        pickle::decode(&missing).unwrap_err().to_string(),
        "entry `x/data/0`: is missing from the archive"
    );
}

#[test]
fn bombs_of_shared_values_go_off_nowhere() {
    // 40 lists, each of ten times the one before.
    let mut laughs = b"]q\0K\x01a".to_vec();
    for level in 0..40_u8 {
        laughs.extend([b']', b'q', level + 1, b'(']);
        laughs.extend([b'h', level].repeat(10));
        laughs.push(b'e');
    }
    assert!(refusal(&program(&laughs), &[]).contains("top level: is a list"));
    let itself = [b"]q\0h\0a".as_slice(), &b"q\0".repeat(100)].concat();
    assert!(refusal(&program(&itself), &[]).contains("top level: is a list"));
    let deep = [b"]".repeat(200_000), b"a".repeat(199_999)].concat();
    assert!(refusal(&program(&deep), &[]).contains("top level: is a list"));
    // One long name, again and again.
    let name = [b"X\x00\x80\0\0".as_slice(), &b"x".repeat(0x8000), b"q\0"].concat();
    let named = [name.as_slice(), b"}(", &b"h\0N".repeat(100_000), b"u"].concat();
    let file = zip(&[("x/data.pkl", &program(&named))]);
    assert!(matches!(pickle::decode(&file).unwrap(), Saved::Dict(entries) if entries.len() == 1));
    let marks = b"(".repeat(500_000);
    assert!(refusal(&program(&marks), &[]).contains("empty stack"));
    let long = program(&b"N".repeat(2 << 20));
    assert!(refusal(&long, &[]).contains("names and shapes of tensors fit into 1048576"));
}

#[test]
fn archives_that_torch_did_not_write_are_refused() {
    let pickle = program(b"}");
    let refused = |file: &[u8]| pickle::decode(file).unwrap_err().to_string();
    assert!(refused(b"").contains("is no whole zip"));
    assert!(refused(b"PK\x03\x04").contains("is no whole zip"));
    assert!(refused(&zip(&[])).contains("no entry `data.pkl`"));
    assert!(
        refused(&zip(&[("x/data.pkl", &pickle), ("y/data.pkl", &pickle)]))
            .contains("more than one entry `data.pkl`")
    );
    assert!(
        refused(&zip(&[("x/data.pkl", &pickle), ("x/data.pkl", &pickle)]))
            .contains("is in the archive twice")
    );
    for name in ["../data.pkl", "/x/data.pkl", "x/../../data.pkl", "x\\data.pkl"] {
        assert!(refused(&zip(&[(name, &pickle)])).contains("leaves its folder"), "{name}");
    }
    let big_endian = zip(&[("x/data.pkl", &pickle), ("x/byteorder", b"big")]);
    assert_eq!(refused(&big_endian), "entry `byteorder`: is not `little`");

    let whole = zip(&[("x/data.pkl", &pickle), ("x/data/0", b"abcd")]);
    assert!(pickle::decode(&whole).is_ok());
    // Fields of the first record of the directory: flags at 8, method at 10, sizes at 20 and 24, offset at 42.
    let directory = whole.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    let patched = |at: usize, value: &[u8]| {
        let mut file = whole.clone();
        file[directory + at..directory + at + value.len()].copy_from_slice(value);
        refused(&file)
    };
    assert!(patched(8, &[1]).contains("is encrypted"));
    assert!(patched(10, &[8]).contains("is compressed, but torch stores as it is"));
    assert!(patched(10, &[12]).contains("is neither stored nor deflated"));
    assert!(patched(24, &[0xff, 0xff, 0xff, 0x7f]).contains("is neither stored nor deflated"));
    assert!(
        patched(20, &[0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 0x7f])
            .contains("does not lie inside the file")
    );
    assert!(patched(42, &[0xff, 0xff, 0xff, 0x7f]).contains("does not lie inside the file"));
    let mut damaged = whole.clone();
    let at = damaged.windows(2).position(|window| window == b"}.").unwrap();
    damaged[at] = b']';
    assert!(refused(&damaged).contains("checksum"));
    // The second record points at the first entry.
    let second =
        directory + 1 + whole[directory + 1..].windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    let mut overlapping = whole.clone();
    overlapping[second + 42..second + 46].fill(0);
    assert!(refused(&overlapping).contains("overlap"), "{}", refused(&overlapping));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_program_of_opcodes_makes_it_panic(body in prop::collection::vec(opcode(), 0..60), storage in prop::collection::vec(any::<u8>(), 0..64)) {
        let file = zip(&[("x/data.pkl", &program(&body.concat())), ("x/data/0", &storage)]);
        if let Ok(value) = pickle::decode(&file) {
            value.into_state_dict().ok();
        }
    }

    #[test]
    fn no_mutation_of_a_real_pickle_makes_it_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let real = bytes("pth/types.pth");
        let mut entries = entries(&real);
        for (place, byte) in changes {
            let pickle = &mut entries[0].1;
            let at = place.index(pickle.len());
            pickle[at] = byte;
        }
        let entries: Vec<(&str, &[u8])> = entries.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
        if let Ok(value) = pickle::decode(&zip(&entries)) {
            value.into_state_dict().ok();
        }
    }
}

/// Opcodes with plausible operands, so that programs get far.
fn opcode() -> impl Strategy<Value = Vec<u8>> {
    let simple = prop::sample::select(b"N\x88\x89()t\x85\x86\x87]ae}suQRb.\x93\x94".to_vec())
        .prop_map(|byte| vec![byte]);
    let words = prop::sample::select(vec![
        b"ccollections\nOrderedDict\n".to_vec(),
        b"ctorch._utils\n_rebuild_tensor_v2\n".to_vec(),
        b"ctorch._utils\n_rebuild_parameter\n".to_vec(),
        b"ctorch\nFloatStorage\n".to_vec(),
        b"X\x07\0\0\0storage".to_vec(),
        b"X\x01\0\0\x000".to_vec(),
        tensor("FloatStorage", 4, b"K\0", b"K\x02\x85", b"K\x01\x85"),
        tensor("BoolStorage", 16, b"K\x01", b"K\x02K\x02\x86", b"K\0K\x03\x86"),
    ]);
    let operand =
        (prop::sample::select(b"Kqh".to_vec()), 0_u8..8).prop_map(|(opcode, byte)| vec![opcode, byte]);
    prop_oneof![4 => simple, 2 => words, 4 => operand, 1 => any::<u8>().prop_map(|byte| vec![byte])]
}
