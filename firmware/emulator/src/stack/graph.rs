//! Who calls whom, and the longest way down.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, bail};

use super::{
    Root,
    code::Step,
    program::{Function, Program},
};

/// How deep a stack gets at most.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bound {
    /// Bytes.
    pub bytes: u64,
    /// Bytes that one interrupt or fault takes on top, its handler's included.
    pub exception: u64,
    /// The functions of the deepest way, each with what it takes.
    pub way: Vec<(String, u64)>,
    /// Functions on any way that call by pointer.
    pub by_pointer: Vec<String>,
}

impl Bound {
    /// The deepest way, a line a function.
    pub fn way(&self) -> String {
        let lines = self.way.iter();
        lines
            .map(|(name, bytes)| format!("  {bytes:>6} {name}\n"))
            .collect()
    }
}

/// Where a second core starts. Its address is in the program, but it is nobody's callee.
const CORE_1: &str = "core1_startup";

/// What a RISC-V's entry goes on with, by its address; nobody else does.
const START: &str = "_start_rust";

/// What the RP2040's library has its boot ROM do, by pointers of the ROM's own table, which lead nowhere else.
const BY_ROM: &str = "__aeabi_mem";

/// Bytes that such a function of the ROM may take: it pushes three registers, or two (`bootrom_misc.S` of
/// raspberrypi/pico-bootrom-rp2040), its look-up some more.
const ROM_FRAME: u64 = 32;

/// A function's part in the graph; functions are named by their addresses.
struct Node {
    name: String,
    frame: Result<u64, String>,
    callees: BTreeSet<u64>,
    calls_by_pointer: bool,
}

pub struct Graph {
    nodes: BTreeMap<u64, Node>,
    /// Functions whose address is somewhere in the program, so that a call by pointer may reach them.
    pointed_at: BTreeSet<u64>,
    entry: u64,
    vectors: BTreeSet<u64>,
    exception_frame: u64,
}

/// What is known of a function while the ways down are walked.
enum Seen {
    /// It is on the way at hand.
    Open,
    /// Bytes from it on, and the callee through which.
    Done(u64, Option<u64>),
}

impl Graph {
    pub fn new(program: Program) -> Result<Graph> {
        let functions = &program.functions;
        // The function that holds an address, and its start.
        let holder = |address: u64| {
            let (start, function) = functions.range(..=address).next_back()?;
            function.range.contains(&address).then_some(*start)
        };
        let tables: BTreeSet<u64> = program
            .pointers
            .iter()
            .filter(|pointer| !functions.contains_key(pointer))
            .filter_map(|pointer| holder(*pointer))
            .collect();
        let mut pointed_at: BTreeSet<u64> = program
            .pointers
            .iter()
            .copied()
            .filter(|pointer| functions.contains_key(pointer))
            .collect();
        let mut nodes = BTreeMap::new();
        for (&start, function) in functions {
            let mut node = Node {
                name: function.name.clone(),
                frame: frame(function),
                callees: BTreeSet::new(),
                calls_by_pointer: false,
            };
            for step in &function.steps {
                match *step {
                    Step::Call(target) | Step::Jump(target) => {
                        // A call into the middle of itself is a far jump.
                        let is_jump = matches!(step, Step::Jump(_)) || target != start;
                        if is_jump && function.range.contains(&target) {
                            continue;
                        }
                        let callee = holder(target).with_context(|| {
                            format!("{} calls {target:#x}, where no function is", node.name)
                        })?;
                        node.callees.insert(callee);
                    }
                    Step::CallPointer => node.calls_by_pointer = true,
                    // With a table of places inside the function it is a `match`.
                    Step::JumpPointer => node.calls_by_pointer |= !tables.contains(&start),
                    Step::Address(address) if functions.contains_key(&address) => {
                        if functions[&address].name == START {
                            // In a function of Rust's it is a number that happens to be the same.
                            if !function.name.contains("::") {
                                node.callees.insert(address);
                            }
                        } else {
                            pointed_at.insert(address);
                        }
                    }
                    Step::Address(_) | Step::Grow(_) | Step::GrowUnknown => {}
                }
            }
            if node.calls_by_pointer && node.name.starts_with(BY_ROM) {
                node.calls_by_pointer = false;
                node.frame = node.frame.map(|bytes| bytes + ROM_FRAME);
            }
            nodes.insert(start, node);
        }
        pointed_at.retain(|start| !nodes[start].name.contains(CORE_1));
        Ok(Graph {
            nodes,
            pointed_at,
            entry: program.entry,
            vectors: program.vectors,
            exception_frame: program.exception_frame,
        })
    }

    /// The deepest from `root` on; an error if there is no bound.
    pub fn bound(&self, root: Root) -> Result<Bound> {
        let root = match root {
            Root::Reset => self.entry,
            Root::Core1 => self.named(CORE_1)?,
        };
        let mut seen = BTreeMap::new();
        let bytes = self.depth(root, &mut seen, &mut Vec::new())?;
        let mut way = Vec::new();
        let mut next = Some(root);
        while let Some(address) = next {
            let node = &self.nodes[&address];
            way.push((node.name.clone(), node.frame.clone().unwrap_or(0)));
            next = match seen.get(&address) {
                Some(Seen::Done(_, callee)) => *callee,
                _ => None,
            };
        }
        let by_pointer = seen.keys().map(|address| &self.nodes[address]);
        let by_pointer = by_pointer
            .filter(|node| node.calls_by_pointer)
            .map(|node| node.name.clone())
            .collect();
        let mut handler = 0;
        for address in &self.vectors {
            handler = handler.max(self.depth(*address, &mut seen, &mut Vec::new())?);
        }
        Ok(Bound {
            bytes,
            exception: self.exception_frame + handler,
            way,
            by_pointer,
        })
    }

    /// The only function whose name has that part.
    fn named(&self, part: &str) -> Result<u64> {
        let found: Vec<_> = self
            .nodes
            .iter()
            .filter(|(_, node)| node.name.contains(part))
            .collect();
        match *found {
            [(address, _)] => Ok(*address),
            _ => bail!("{} functions are named {part}", found.len()),
        }
    }

    fn depth(&self, address: u64, seen: &mut BTreeMap<u64, Seen>, way: &mut Vec<u64>) -> Result<u64> {
        let node = self
            .nodes
            .get(&address)
            .with_context(|| format!("no function at {address:#x}"))?;
        match seen.get(&address) {
            Some(Seen::Done(bytes, _)) => return Ok(*bytes),
            Some(Seen::Open) => {
                let start = way.iter().position(|on_it| *on_it == address).unwrap_or(0);
                let names = way[start..].iter().map(|on_it| &*self.nodes[on_it].name);
                bail!(
                    "a recursion, which has no bound: {}",
                    names.collect::<Vec<_>>().join(" -> ")
                );
            }
            None => {}
        }
        seen.insert(address, Seen::Open);
        way.push(address);
        let by_pointer = node.calls_by_pointer.then_some(&self.pointed_at);
        let mut deepest = (0, None);
        for &callee in node.callees.iter().chain(by_pointer.into_iter().flatten()) {
            let bytes = self.depth(callee, seen, way)?;
            if bytes > deepest.0 {
                deepest = (bytes, Some(callee));
            }
        }
        way.pop();
        let frame = node.frame.clone().map_err(anyhow::Error::msg)?;
        let bytes = frame + deepest.0;
        seen.insert(address, Seen::Done(bytes, deepest.1));
        Ok(bytes)
    }
}

/// What the compiler says, else what the code takes off the stack pointer anywhere.
fn frame(function: &Function) -> Result<u64, String> {
    if let Some(bytes) = function.frame {
        return Ok(bytes);
    }
    let mut sum = 0;
    for step in &function.steps {
        match step {
            Step::Grow(bytes) => sum += bytes,
            Step::GrowUnknown => return Err(format!("{} takes an unknown part of the stack", function.name)),
            _ => {}
        }
    }
    Ok(sum)
}
