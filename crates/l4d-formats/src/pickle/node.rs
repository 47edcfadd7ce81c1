//! What a pickle describes: nodes that refer to each other by number.

use crate::element::{Element, View};

/// Number of a node.
pub(super) type Id = u32;

/// A part of the value that a pickle describes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    None,
    Bool,
    Int(i64),
    Float,
    Text(Box<str>),
    Tuple(Vec<Id>),
    List,
    Dict(Vec<(Id, Id)>),
    Global(Global),
    Storage(Box<Storage>),
    /// A number of numpy, whose value is not looked at.
    Scalar,
    /// A view of a storage, not yet checked against it.
    Tensor(Id, Box<View>),
}

impl Node {
    /// The Python type, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool => "a bool",
            Self::Int(_) => "an int",
            Self::Float => "a float",
            Self::Text(_) => "a string",
            Self::Tuple(_) => "a tuple",
            Self::List => "a list",
            Self::Dict(_) => "a dict",
            Self::Global(_) => "a class or function",
            Self::Scalar => "a number of numpy",
            Self::Storage(_) => "a storage",
            Self::Tensor(..) => "a tensor",
        }
    }
}

/// Numbers in an entry of the archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Storage {
    /// Entry below `data/`.
    pub(super) key: Box<str>,
    pub(super) element: Element,
    /// Numbers in it.
    pub(super) count: usize,
}

/// A Python name that a pickle of tensors may use, each with its one meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Global {
    /// `collections.OrderedDict`: called without arguments, an empty dict.
    OrderedDict,
    /// `torch._utils._rebuild_tensor_v2`: a view of a storage.
    RebuildTensor,
    /// `torch._utils._rebuild_parameter`: the tensor that is its first argument.
    RebuildParameter,
    /// What a number of numpy is made of: its type and its bytes.
    Scalar,
    /// `torch.FloatStorage` and its like: the type of a storage, never called.
    Storage(Element),
}

impl Global {
    /// The meaning of a name; none is the refusal of everything else.
    pub(super) fn find(module: &str, name: &str) -> Option<Self> {
        Some(match (module, name) {
            ("collections", "OrderedDict") => Self::OrderedDict,
            ("torch._utils", "_rebuild_tensor_v2") => Self::RebuildTensor,
            ("torch._utils", "_rebuild_parameter") => Self::RebuildParameter,
            ("numpy", "dtype")
            | ("numpy.core.multiarray" | "numpy._core.multiarray", "scalar")
            | ("_codecs", "encode") => Self::Scalar,
            ("torch", "DoubleStorage") => Self::Storage(Element::F64),
            ("torch", "FloatStorage") => Self::Storage(Element::F32),
            ("torch", "HalfStorage") => Self::Storage(Element::F16),
            ("torch", "BFloat16Storage") => Self::Storage(Element::Bf16),
            ("torch", "LongStorage") => Self::Storage(Element::I64),
            ("torch", "IntStorage") => Self::Storage(Element::I32),
            ("torch", "ShortStorage") => Self::Storage(Element::I16),
            ("torch", "CharStorage") => Self::Storage(Element::I8),
            ("torch", "ByteStorage") => Self::Storage(Element::U8),
            ("torch", "BoolStorage") => Self::Storage(Element::Bool),
            _ => return None,
        })
    }
}
