//! The stack machine of a pickle, reduced to what tensors need.
//!
//! Every opcode takes at least one byte and makes at most one node, and nodes refer to each other by number: sharing
//! costs nothing here, however often a pickle repeats itself, and nothing is ever copied or followed.

use std::collections::BTreeMap;

use super::HINT;
use super::node::{Global, Id, Node};
use crate::fault::{Fault, quoted};

/// Runs a pickle to its end: all nodes, and the number of the one that is the value.
pub(super) fn run(bytes: &[u8]) -> Result<(Vec<Node>, Id), Fault> {
    let mut machine = Machine {
        bytes,
        at: 0,
        start: 0,
        nodes: Vec::new(),
        stack: Vec::new(),
        marks: Vec::new(),
        memo: BTreeMap::new(),
    };
    while machine.step()? {}
    let root = machine.pop()?;
    Ok((machine.nodes, root))
}

pub(super) struct Machine<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the running opcode is.
    start: usize,
    nodes: Vec<Node>,
    pub(super) stack: Vec<Id>,
    /// Heights of the stack at which marks are.
    marks: Vec<usize>,
    memo: BTreeMap<u32, Id>,
}

impl<'a> Machine<'a> {
    /// Carries out one opcode; false at the end.
    fn step(&mut self) -> Result<bool, Fault> {
        self.start = self.at;
        match self.byte()? {
            b'.' => return Ok(false),
            // PROTO, FRAME
            0x80 => self.protocol()?,
            0x95 => self.array::<8>().map(|_length| ())?,
            b'N' => self.push(Node::None),
            0x88 | 0x89 => self.push(Node::Bool),
            // BININT, BININT1, BININT2, LONG1, BINFLOAT
            b'J' => self.array().map(|word| self.push(Node::Int(i32::from_le_bytes(word).into())))?,
            b'K' => self.byte().map(|word| self.push(Node::Int(word.into())))?,
            b'M' => self.array().map(|word| self.push(Node::Int(u16::from_le_bytes(word).into())))?,
            0x8a => self.long()?,
            b'G' => self.array::<8>().map(|_number| self.push(Node::Float))?,
            // BINUNICODE, SHORT_BINUNICODE
            b'X' => self.word().and_then(|length| self.text(length as usize))?,
            0x8c => self.byte().and_then(|length| self.text(length.into()))?,
            b'(' => self.marks.push(self.stack.len()),
            // EMPTY_TUPLE, TUPLE, TUPLE1, TUPLE2, TUPLE3
            b')' => self.push(Node::Tuple(Vec::new())),
            b't' => self.pop_marked().map(|items| self.push(Node::Tuple(items)))?,
            count @ 0x85..=0x87 => self.short_tuple(usize::from(count - 0x84))?,
            // EMPTY_LIST, APPEND, APPENDS
            b']' => self.push(Node::List),
            b'a' => self.pop().and_then(|_item| self.append())?,
            b'e' => self.pop_marked().and_then(|_items| self.append())?,
            // EMPTY_DICT, SETITEM, SETITEMS
            b'}' => self.push(Node::Dict(Vec::new())),
            b's' => self.pop_many(2).and_then(|items| self.set_items(&items))?,
            b'u' => self.pop_marked().and_then(|items| self.set_items(&items))?,
            // GLOBAL, STACK_GLOBAL, BINPERSID, REDUCE, BUILD
            b'c' => self.names().and_then(|(module, name)| self.global(module, name))?,
            0x93 => self.stack_global()?,
            b'Q' => self.storage()?,
            b'R' => self.reduce()?,
            b'b' => self.build()?,
            // BINPUT, LONG_BINPUT, MEMOIZE, BINGET, LONG_BINGET
            b'q' => self.byte().and_then(|slot| self.put(slot.into()))?,
            b'r' => self.word().and_then(|slot| self.put(slot))?,
            0x94 => self.put(self.memo.len() as u32)?,
            b'h' => self.byte().and_then(|slot| self.get(slot.into()))?,
            b'j' => self.word().and_then(|slot| self.get(slot))?,
            // INST names a class as GLOBAL does, and always calls it.
            b'i' => return self.names().and_then(|(module, name)| Err(self.refuse_global(module, name))),
            opcode => return Err(self.refuse_opcode(opcode)),
        }
        Ok(true)
    }

    pub(super) fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(format!("data.pkl, byte {}", self.start), message, HINT)
    }

    fn refuse_opcode(&self, opcode: u8) -> Fault {
        let name = match opcode {
            0x81 => "NEWOBJ, which makes an object of a class",
            0x92 => "NEWOBJ_EX, which makes an object of a class",
            b'o' => "OBJ, which makes an object of a class",
            b'P' => "PERSID, which tensors do not need",
            0x82..=0x84 => "EXT, which names a class of a registry",
            0x96..=0x98 => "a buffer, which tensors do not need",
            _ => "not one that tensors need",
        };
        self.fault(format!("opcode 0x{opcode:02x} is {name}; nothing was executed"))
    }

    fn refuse_global(&self, module: &str, name: &str) -> Fault {
        self.fault(format!(
            "names {}, which is no part of a tensor; nothing was executed",
            quoted(&format!("{module}.{name}"))
        ))
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let taken = self.at.checked_add(count).and_then(|end| self.bytes.get(self.at..end));
        let taken = taken.ok_or_else(|| self.fault("is cut: the pickle ends within an opcode"))?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let taken = self.take(N)?;
        taken.first_chunk().copied().ok_or_else(|| self.fault("is cut"))
    }

    fn byte(&mut self) -> Result<u8, Fault> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    fn word(&mut self) -> Result<u32, Fault> {
        self.array().map(u32::from_le_bytes)
    }

    /// Module and name, a line each.
    fn names(&mut self) -> Result<(&'a str, &'a str), Fault> {
        Ok((self.line()?, self.line()?))
    }

    fn line(&mut self) -> Result<&'a str, Fault> {
        let rest = self.bytes.get(self.at..).unwrap_or(&[]);
        let end = rest
            .iter()
            .position(|&byte| byte == b'\n')
            .ok_or_else(|| self.fault("is cut: a name has no end"))?;
        self.at += end + 1;
        std::str::from_utf8(&rest[..end])
            .map_err(|error| self.fault(format!("has a name that is no text: {error}")))
    }

    pub(super) fn push(&mut self, node: Node) {
        self.stack.push(self.nodes.len() as Id);
        self.nodes.push(node);
    }

    pub(super) fn node(&self, id: Id) -> &Node {
        self.nodes.get(id as usize).unwrap_or(&Node::None)
    }

    pub(super) fn pop(&mut self) -> Result<Id, Fault> {
        let floor = self.marks.last().copied().unwrap_or(0);
        let above = self.stack.pop().filter(|_| self.stack.len() >= floor);
        above.ok_or_else(|| self.fault("takes from an empty stack"))
    }

    /// The last values, the oldest first.
    fn pop_many(&mut self, count: usize) -> Result<Vec<Id>, Fault> {
        let mut items = (0..count).map(|_| self.pop()).collect::<Result<Vec<Id>, Fault>>()?;
        items.reverse();
        Ok(items)
    }

    fn pop_marked(&mut self) -> Result<Vec<Id>, Fault> {
        let mark = self.marks.pop().ok_or_else(|| self.fault("has no mark to go back to"))?;
        Ok(self.stack.split_off(mark.min(self.stack.len())))
    }

    /// The last value, which stays.
    pub(super) fn top(&self) -> Result<Id, Fault> {
        let floor = self.marks.last().copied().unwrap_or(0);
        let top = self.stack.get(floor..).and_then(|above| above.last()).copied();
        top.ok_or_else(|| self.fault("needs a value on the stack"))
    }

    fn protocol(&mut self) -> Result<(), Fault> {
        let version = self.byte()?;
        if !(2..=5).contains(&version) {
            return Err(self.fault(format!("has pickle protocol {version}, but torch writes 2 to 5")));
        }
        Ok(())
    }

    fn long(&mut self) -> Result<(), Fault> {
        let length = usize::from(self.byte()?);
        let bytes = self.take(length)?;
        if length > 8 {
            return Err(self.fault("has an integer of more than 64 bits"));
        }
        let negative = bytes.last().is_some_and(|&byte| byte >= 0x80);
        let mut word = [if negative { 0xff } else { 0 }; 8];
        word[..length].copy_from_slice(bytes);
        self.push(Node::Int(i64::from_le_bytes(word)));
        Ok(())
    }

    fn text(&mut self, length: usize) -> Result<(), Fault> {
        let bytes = self.take(length)?;
        let text = std::str::from_utf8(bytes)
            .map_err(|error| self.fault(format!("has a string that is no text: {error}")))?;
        self.push(Node::Text(text.into()));
        Ok(())
    }

    fn short_tuple(&mut self, count: usize) -> Result<(), Fault> {
        self.pop_many(count).map(|items| self.push(Node::Tuple(items)))
    }

    /// Nothing that tensors need is in a list: what goes in is dropped.
    fn append(&mut self) -> Result<(), Fault> {
        match self.node(self.top()?) {
            Node::List => Ok(()),
            other => Err(self.fault(format!("appends to {}", other.kind()))),
        }
    }

    fn set_items(&mut self, items: &[Id]) -> Result<(), Fault> {
        let (pairs, odd) = items.as_chunks::<2>();
        if !odd.is_empty() {
            return Err(self.fault("has a key without a value"));
        }
        let top = self.top()?;
        match self.nodes.get_mut(top as usize) {
            Some(Node::Dict(dict)) => dict.extend(pairs.iter().map(|&[key, value]| (key, value))),
            _ => return Err(self.fault(format!("sets items of {}", self.node(top).kind()))),
        }
        Ok(())
    }

    fn put(&mut self, slot: u32) -> Result<(), Fault> {
        let top = self.top()?;
        self.memo.insert(slot, top);
        Ok(())
    }

    fn get(&mut self, slot: u32) -> Result<(), Fault> {
        let missing = || self.fault(format!("asks for memo {slot}, which was not put"));
        let id = self.memo.get(&slot).copied().ok_or_else(missing)?;
        self.stack.push(id);
        Ok(())
    }

    fn global(&mut self, module: &str, name: &str) -> Result<(), Fault> {
        let global = Global::find(module, name).ok_or_else(|| self.refuse_global(module, name))?;
        self.push(Node::Global(global));
        Ok(())
    }

    fn stack_global(&mut self) -> Result<(), Fault> {
        let (name, module) = (self.pop()?, self.pop()?);
        let (Node::Text(module), Node::Text(name)) = (self.node(module).clone(), self.node(name).clone())
        else {
            return Err(self.fault("names a class by something other than strings"));
        };
        self.global(&module, &name)
    }
}
