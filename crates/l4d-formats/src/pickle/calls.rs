//! The calls that a pickle of tensors makes, each in its one meaning.

use super::machine::Machine;
use super::node::{Global, Id, Node, Storage};
use crate::element::View;
use crate::fault::Fault;
use crate::tensor::element_count;

/// Axes of a tensor.
const MOST_AXES: usize = 16;

impl Machine<'_> {
    /// `("storage", type, key, device, count)`
    pub(super) fn storage(&mut self) -> Result<(), Fault> {
        let id = self.pop()?;
        let storage = self
            .describe_storage(id)
            .ok_or_else(|| self.fault("refers to something other than a storage"))?;
        self.push(Node::Storage(Box::new(storage)));
        Ok(())
    }

    fn describe_storage(&self, id: Id) -> Option<Storage> {
        let Node::Tuple(items) = self.node(id) else { return None };
        let &[tag, kind, key, _device, count] = items.as_slice() else { return None };
        let (Node::Text(tag), Node::Global(Global::Storage(element)), Node::Text(key), Node::Int(count)) =
            (self.node(tag), self.node(kind), self.node(key), self.node(count))
        else {
            return None;
        };
        let plain = !key.is_empty()
            && key.len() <= 40
            && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        if &**tag != "storage" || !plain {
            return None;
        }
        Some(Storage { key: key.clone(), element: *element, count: usize::try_from(*count).ok()? })
    }

    pub(super) fn reduce(&mut self) -> Result<(), Fault> {
        let (arguments, callable) = (self.pop()?, self.pop()?);
        let Node::Tuple(arguments) = self.node(arguments) else {
            return Err(self.fault("calls with something other than a tuple"));
        };
        let arguments = arguments.clone();
        match *self.node(callable) {
            Node::Global(Global::OrderedDict) if arguments.is_empty() => self.push(Node::Dict(Vec::new())),
            Node::Global(Global::RebuildTensor) => {
                let (storage, view) = self.describe_view(&arguments)?;
                self.push(Node::Tensor(storage, Box::new(view)));
            }
            Node::Global(Global::RebuildParameter) => match arguments.as_slice() {
                &[tensor, _requires_grad, _hooks] if matches!(self.node(tensor), Node::Tensor(..)) => {
                    self.stack.push(tensor);
                }
                _ => return Err(self.fault("makes a parameter of something other than a tensor")),
            },
            Node::Global(Global::Scalar) => self.push(Node::Scalar),
            Node::Global(_) => {
                let message = "calls a class in a way that tensors do not need; nothing was executed";
                return Err(self.fault(message));
            }
            ref other => return Err(self.fault(format!("calls {}; nothing was executed", other.kind()))),
        }
        Ok(())
    }

    /// `_rebuild_tensor_v2(storage, offset, shape, strides, requires_grad, hooks[, metadata])`
    fn describe_view(&self, arguments: &[Id]) -> Result<(Id, View), Fault> {
        let count = arguments.len();
        let (&[storage, offset, shape, strides, ..], 6 | 7) = (arguments, count) else {
            return Err(self.fault(format!("makes a tensor of {count} arguments instead of 6 or 7")));
        };
        if !matches!(self.node(storage), Node::Storage(_)) {
            return Err(self.fault(format!("makes a tensor of {}", self.node(storage).kind())));
        }
        let none = |what: &str| self.fault(format!("has {what} of counts"));
        let offset = self.size(offset).ok_or_else(|| self.fault("has an offset that is no count"))?;
        let shape = self.sizes(shape).ok_or_else(|| none("a shape that is no tuple"))?;
        let strides = self.sizes(strides).ok_or_else(|| none("strides that are no tuple"))?;
        if shape.len() != strides.len() {
            return Err(self.fault(format!("has {} axes and {} strides", shape.len(), strides.len())));
        }
        if element_count(&shape).is_none() {
            return Err(self.fault(format!("has the shape {shape:?}, which fits into no machine")));
        }
        Ok((storage, View { offset, shape, strides }))
    }

    fn size(&self, id: Id) -> Option<usize> {
        match *self.node(id) {
            Node::Int(value) => usize::try_from(value).ok(),
            _ => None,
        }
    }

    fn sizes(&self, id: Id) -> Option<Vec<usize>> {
        match self.node(id) {
            Node::Tuple(items) if items.len() <= MOST_AXES => {
                items.iter().map(|&item| self.size(item)).collect()
            }
            _ => None,
        }
    }

    /// A state dict carries `_metadata` (versions of its modules) as an attribute, which nothing needs.
    pub(super) fn build(&mut self) -> Result<(), Fault> {
        let state = self.pop()?;
        let target = self.top()?;
        match (self.node(target), self.node(state)) {
            (Node::Dict(_), Node::Dict(_) | Node::None) | (Node::Scalar, Node::Tuple(_)) => Ok(()),
            (other, _) => {
                Err(self.fault(format!("sets the state of {}; nothing was executed", other.kind())))
            }
        }
    }
}
