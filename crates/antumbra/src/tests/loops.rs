//! Every loop of every shader ends by its form, whatever is in memory: a slow GPU's watchdog takes the host's device away
//! where one does not.
//!
//! A loop passes where one of its variables is a *counter* or a *set of bits*, and a *guard* that every turn meets ends
//! the loop by it:
//!
//! - A counter is a local integer that one place alone changes, once a turn: by a step up or down, a factor, a shift.
//! - A set of bits is a local integer that the loop only takes bits from, the lowest at least once a turn.
//! - The guard is the loop's condition, its `break if`, or an `if` of the body that every turn comes to, and holds the
//!   counter against a *known* limit, or the bits against zero.
//!
//! Known is what cannot grow without bound by what is in memory: constants, overrides, uniforms (which the processor
//! fills), lengths of arrays, sizes of textures, places in the dispatch, and what is made of these; the smaller of two
//! numbers where one is known. Not known is what comes from storage, textures and atomics, or between stages. It is found
//! as the largest set that the shader does not contradict, over all its functions. Arithmetic is taken to be free of
//! overflow where it is of known numbers alone.

use std::collections::HashMap;

use naga::{
    AddressSpace, BinaryOperator, Binding, Block, BuiltIn, Expression, Function, Handle, Literal, LocalVariable,
    MathFunction, Module, ScalarKind, Statement, TypeInner, UnaryOperator,
};

use super::module;
use crate::shaders;

#[test]
fn every_loop_ends_by_its_form() {
    let mut loops = 0;
    let mut all_unbounded = Vec::new();
    for (path, wgsl) in shaders::ALL {
        let (count, unbounded) = unbounded_loops(path, &shaders::text_of(wgsl));
        loops += count;
        all_unbounded.extend(unbounded.into_iter().map(|what| format!("{path}, linked: {what}")));
    }
    assert!(all_unbounded.is_empty(), "{}", all_unbounded.join("\n"));
    assert!(loops > 100, "{loops} loops");
}

/// Those of what laboratory and viewer draw with, which links no shaders: it puts files together.
#[test]
fn every_loop_of_shading_ends_by_its_form() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../antumbra-render/src/");
    let read = |file: &str| std::fs::read_to_string(format!("{source}{file}")).expect("a shader of the crate");
    let wgsl = ["receivers/receivers.wgsl", "shading/irradiance.wgsl", "shading/bent.wgsl"].map(read).concat();
    let (count, unbounded) = unbounded_loops("bent.wgsl", &wgsl);
    assert!(count > 2 && unbounded.is_empty(), "of {count} loops: {}", unbounded.join("\n"));
}

const HEAD: &str = "
    @group(0) @binding(0) var<uniform> count: u32;
    @group(0) @binding(1) var<storage, read_write> words: array<u32>;
    fn f() -> u32 {
        var sum = 0u;
        var i = 0u;
    ";

#[test]
fn loops_with_bounds_pass() {
    for body in [
        "for (var k = 0u; k < 8u; k++) { sum += k; }",
        "for (var k = 0; k <= i32(count); k += 2) { sum += 1u; }",
        "for (; 2u * i < count && words[i] != 0u; i++) {}",
        "for (; words[i] != 0u && 2u * i < count; i++) {}",
        "while i < min(words[0], count) { sum += words[i]; i++; }",
        "for (i = words[0]; i < arrayLength(&words); i++) { if words[i] == 3u { continue; } sum++; }",
        "loop { sum += words[i]; continuing { i++; break if (words[i] == 0u) | (i >= count); } }",
        "loop { sum += words[i]; continuing { i++; break if words[i] == 0u || i >= count; } }",
        "for (var k = 1u; ; k++) { if k >= count { break; } sum++; }",
        "for (var k = count; k > 0u; k--) { sum++; }",
        "for (var k = 1u; k < count; k *= 2u) { sum++; }",
        "for (var k = words[1]; k != 0u; k &= k - 1u) { sum++; }",
        "var k = words[1]; while k != 0u { let j = firstTrailingBit(k); k &= k - 1u; k &= words[j]; }",
    ] {
        let (count, unbounded) = unbounded_loops(body, &format!("{HEAD}{body} return sum; }}"));
        assert!(count == 1 && unbounded.is_empty(), "{body}: {unbounded:?}");
    }
}

#[test]
fn loops_without_bounds_do_not() {
    for body in [
        // By what is in memory.
        "for (var k = 0u; k < words[0]; k++) { sum++; }",
        "let end = words[0]; for (var k = 0u; k < end; k++) { sum++; }",
        "for (var node = words[0]; node != 0u; node = words[node]) { sum++; }",
        "for (var k = words[0]; k > 0u; k--) { sum++; }",
        "while words[i] < count { i++; }",
        // A limit that the loop moves on.
        "var end = 1u; for (var k = 0u; k < end; k++) { end = words[k]; }",
        // The wrong way, not at all, or not always.
        "for (; i < count; i--) {}",
        "for (; i < count; i += 0u) {}",
        "while i < count { if words[i] == 0u { i++; } }",
        "while i < count { if words[i] == 0u { continue; } i++; }",
        "for (; i < count; i++) { if words[i] == 0u { i = 0u; } }",
        "for (; i >= 0u; i--) {}",
        // A guard that not every turn meets, or that asks for more.
        "loop { if words[i] == 0u { continue; } if i >= count { break; } continuing { i++; } }",
        "loop { if i >= count && words[i] == 0u { break; } continuing { i++; } }",
        "for (; i < count || words[i] == 0u; i++) {}",
        // Floats may be no numbers, and may not move.
        "var x = 0.0; while x < 8.0 { x += 1.0; }",
        // Bits that come back.
        "var k = words[1]; while k != 0u { k &= k - 1u; k |= words[2]; }",
        "loop {}",
    ] {
        let (count, unbounded) = unbounded_loops(body, &format!("{HEAD}{body} return sum; }}"));
        assert!(count == 1 && unbounded.len() == 1, "{body}");
    }
}

#[test]
fn limits_are_followed_through_calls_and_variables() {
    let shader = |limit: &str| {
        format!(
            "@group(0) @binding(0) var<storage, read> words: array<u32>;
            var<workgroup> shared_limit: u32;
            fn limit() -> u32 {{ return {limit}; }}
            fn walk(end: u32) {{ for (var k = 0u; k < end; k++) {{ shared_limit += words[k] * 0u; }} }}
            @compute @workgroup_size(1) fn main() {{ shared_limit = limit(); let end = limit(); walk(end); }}"
        )
    };
    assert!(unbounded_loops("known", &shader("min(words[0], 8u)")).1.is_empty());
    assert_eq!(unbounded_loops("unknown", &shader("words[0]")).1.len(), 1);
}

/// How many loops a shader has, and the lines of those that do not pass.
fn unbounded_loops(path: &str, wgsl: &str) -> (usize, Vec<String>) {
    let module = module(path, wgsl);
    let known = Known::of(&module);
    let mut count = 0;
    let mut unbounded = Vec::new();
    for scope in scopes(&module) {
        let stores = stores_of(&scope.function.body, scope.function);
        for_each_block(&scope.function.body, &mut |block| {
            for (statement, span) in block.span_iter() {
                if let Statement::Loop { body, continuing, break_if } = statement {
                    count += 1;
                    let a_loop = Loop { known: &known, scope, stores: &stores, body, continuing, break_if: *break_if };
                    if !a_loop.ends() {
                        let name = scope.function.name.as_deref().unwrap_or("?");
                        let line = wgsl[span.to_range().expect("parsed from text")].lines().next().unwrap_or_default();
                        unbounded.push(format!("`{line}` in {name} has no bound by its form"));
                    }
                }
            }
        });
    }
    (count, unbounded)
}

/// A function; `id` is its handle, or none for entry points, whose arguments are the pipeline's.
#[derive(Clone, Copy)]
struct Scope<'a> {
    module: &'a Module,
    function: &'a Function,
    id: ScopeId,
}

/// A function's or, behind those, an entry point's place.
type ScopeId = (bool, usize);

fn scopes(module: &Module) -> Vec<Scope<'_>> {
    let functions =
        module.functions.iter().map(|(handle, function)| Scope { module, function, id: (false, handle.index()) });
    let entries = module.entry_points.iter().enumerate().map(|(i, entry)| Scope {
        module,
        function: &entry.function,
        id: (true, i),
    });
    functions.chain(entries).collect()
}

fn for_each_block<'a>(block: &'a Block, visit: &mut impl FnMut(&'a Block)) {
    visit(block);
    for statement in block.iter() {
        for inner in inner_blocks(statement) {
            for_each_block(inner, visit);
        }
    }
}

fn inner_blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        _ => Vec::new(),
    }
}

/// The variable that a pointer is to, or into.
fn root(function: &Function, pointer: Handle<Expression>) -> &Expression {
    match &function.expressions[pointer] {
        Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => root(function, *base),
        expression => expression,
    }
}

/// What is written to each local variable; none where a called function may write anything.
type Stores = HashMap<Handle<LocalVariable>, Vec<Option<Handle<Expression>>>>;

fn stores_of(block: &Block, function: &Function) -> Stores {
    let mut stores = Stores::new();
    for_each_block(block, &mut |block| {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, value } => {
                    if let Expression::LocalVariable(local) = root(function, *pointer) {
                        stores.entry(*local).or_default().push(Some(*value));
                    }
                }
                Statement::Call { arguments, .. } => {
                    for argument in arguments {
                        if let Expression::LocalVariable(local) = root(function, *argument) {
                            stores.entry(*local).or_default().push(None);
                        }
                    }
                }
                _ => {}
            }
        }
    });
    stores
}

/// Variables, arguments and results that are not known.
#[derive(Default, PartialEq)]
struct Known {
    unknown_locals: HashMap<(ScopeId, usize), ()>,
    unknown_globals: HashMap<usize, ()>,
    unknown_arguments: HashMap<(ScopeId, u32), ()>,
    unknown_results: HashMap<ScopeId, ()>,
}

impl Known {
    /// All is known until a statement says otherwise.
    fn of(module: &Module) -> Self {
        let mut known = Self::default();
        loop {
            let before = known.len();
            for scope in scopes(module) {
                for_each_block(&scope.function.body, &mut |block| {
                    for statement in block.iter() {
                        known.note(scope, statement);
                    }
                });
            }
            if known.len() == before {
                return known;
            }
        }
    }

    fn len(&self) -> usize {
        self.unknown_locals.len()
            + self.unknown_globals.len()
            + self.unknown_arguments.len()
            + self.unknown_results.len()
    }

    fn note(&mut self, scope: Scope<'_>, statement: &Statement) {
        let function = scope.function;
        match statement {
            Statement::Store { pointer, value } if !self.knows(scope, *value) => self.forget(scope, *pointer),
            Statement::Atomic { pointer, .. } => self.forget(scope, *pointer),
            Statement::Call { function: callee, arguments, .. } => {
                for (i, argument) in (0..).zip(arguments) {
                    let is_pointer = matches!(
                        root(function, *argument),
                        Expression::LocalVariable(_) | Expression::GlobalVariable(_) | Expression::FunctionArgument(_)
                    ) && !matches!(function.expressions[*argument], Expression::FunctionArgument(_));
                    if is_pointer {
                        self.forget(scope, *argument);
                    }
                    if is_pointer || !self.knows(scope, *argument) {
                        self.unknown_arguments.insert(((false, callee.index()), i), ());
                    }
                }
            }
            Statement::Return { value: Some(value) } if !self.knows(scope, *value) => {
                self.unknown_results.insert(scope.id, ());
            }
            _ => {}
        }
    }

    fn forget(&mut self, scope: Scope<'_>, pointer: Handle<Expression>) {
        match root(scope.function, pointer) {
            Expression::LocalVariable(local) => self.unknown_locals.insert((scope.id, local.index()), ()),
            Expression::GlobalVariable(global) => self.unknown_globals.insert(global.index(), ()),
            _ => None,
        };
    }

    /// Whether a value is known, or a pointer is to what is.
    fn knows(&self, scope: Scope<'_>, expression: Handle<Expression>) -> bool {
        let knows = |expression: &Handle<Expression>| self.knows(scope, *expression);
        match &scope.function.expressions[expression] {
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_)
            | Expression::ArrayLength(_)
            | Expression::ImageQuery { .. }
            | Expression::Relational { .. } => true,
            Expression::Compose { components, .. } => components.iter().all(knows),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => knows(base),
            Expression::Splat { value, .. } => knows(value),
            Expression::Swizzle { vector, .. } => knows(vector),
            Expression::Load { pointer } => knows(pointer),
            Expression::LocalVariable(local) => !self.unknown_locals.contains_key(&(scope.id, local.index())),
            Expression::GlobalVariable(global) => match scope.module.global_variables[*global].space {
                AddressSpace::Uniform => true,
                AddressSpace::WorkGroup | AddressSpace::Private => !self.unknown_globals.contains_key(&global.index()),
                _ => false,
            },
            Expression::FunctionArgument(i) if scope.id.0 => is_place(&scope.function.arguments[*i as usize].binding),
            Expression::FunctionArgument(i) => !self.unknown_arguments.contains_key(&(scope.id, *i)),
            Expression::Unary { expr, .. } => knows(expr),
            Expression::As { expr, .. } => knows(expr),
            Expression::Binary { op, left, right } => match op {
                BinaryOperator::And => knows(left) || knows(right),
                BinaryOperator::Modulo => knows(right),
                BinaryOperator::Equal
                | BinaryOperator::NotEqual
                | BinaryOperator::Less
                | BinaryOperator::LessEqual
                | BinaryOperator::Greater
                | BinaryOperator::GreaterEqual
                | BinaryOperator::LogicalAnd
                | BinaryOperator::LogicalOr => true,
                _ => knows(left) && knows(right),
            },
            Expression::Select { accept, reject, .. } => knows(accept) && knows(reject),
            Expression::Math { fun, arg, arg1, arg2, .. } => match fun {
                MathFunction::Min => knows(arg) || arg1.as_ref().is_some_and(knows),
                MathFunction::Clamp => arg1.as_ref().is_some_and(knows) && arg2.as_ref().is_some_and(knows),
                MathFunction::Saturate
                | MathFunction::Fract
                | MathFunction::Sign
                | MathFunction::CountOneBits
                | MathFunction::CountTrailingZeros
                | MathFunction::CountLeadingZeros => true,
                _ => [Some(arg), arg1.as_ref(), arg2.as_ref()].into_iter().flatten().all(knows),
            },
            Expression::CallResult(function) => !self.unknown_results.contains_key(&(false, function.index())),
            Expression::WorkGroupUniformLoadResult { .. } => {
                uniform_load(&scope.function.body, expression).is_some_and(|pointer| knows(&pointer))
            }
            _ => false,
        }
    }
}

/// Whether a stage's input is a place in the dispatch or the draw.
fn is_place(binding: &Option<Binding>) -> bool {
    matches!(
        binding,
        Some(Binding::BuiltIn(
            BuiltIn::GlobalInvocationId
                | BuiltIn::LocalInvocationId
                | BuiltIn::LocalInvocationIndex
                | BuiltIn::WorkGroupId
                | BuiltIn::NumWorkGroups
                | BuiltIn::VertexIndex
                | BuiltIn::InstanceIndex
        ))
    )
}

fn uniform_load(block: &Block, wanted: Handle<Expression>) -> Option<Handle<Expression>> {
    let mut found = None;
    for_each_block(block, &mut |block| {
        for statement in block.iter() {
            if let Statement::WorkGroupUniformLoad { pointer, result } = statement
                && *result == wanted
            {
                found = Some(*pointer);
            }
        }
    });
    found
}

/// How a variable changes from turn to turn.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Up,
    Down,
    /// Loses bits, the lowest at least: ends at zero.
    Bits,
}

struct Loop<'a> {
    known: &'a Known,
    scope: Scope<'a>,
    /// Of the whole function.
    stores: &'a Stores,
    body: &'a Block,
    continuing: &'a Block,
    break_if: Option<Handle<Expression>>,
}

impl Loop<'_> {
    fn ends(&self) -> bool {
        let mut stores = stores_of(self.body, self.scope.function);
        for (local, values) in stores_of(self.continuing, self.scope.function) {
            stores.entry(local).or_default().extend(values);
        }
        let changes = stores.iter().filter_map(|(local, values)| Some((*local, self.change(*local, values)?)));
        changes.into_iter().any(|(local, change)| self.has_guard(local, change))
    }

    fn expression(&self, expression: Handle<Expression>) -> &Expression {
        &self.scope.function.expressions[expression]
    }

    fn knows(&self, expression: Handle<Expression>) -> bool {
        self.known.knows(self.scope, expression)
    }

    fn is_load_of(&self, expression: Handle<Expression>, local: Handle<LocalVariable>) -> bool {
        matches!(self.expression(expression), Expression::Load { pointer }
            if matches!(self.expression(*pointer), Expression::LocalVariable(of) if *of == local))
    }

    fn literal(&self, expression: Handle<Expression>) -> Option<i64> {
        match self.expression(expression) {
            Expression::Literal(Literal::U32(value)) => Some((*value).into()),
            Expression::Literal(Literal::I32(value)) => Some((*value).into()),
            Expression::Constant(constant) => {
                match self.scope.module.global_expressions[self.scope.module.constants[*constant].init] {
                    Expression::Literal(Literal::U32(value)) => Some(value.into()),
                    Expression::Literal(Literal::I32(value)) => Some(value.into()),
                    _ => None,
                }
            }
            Expression::ZeroValue(_) => Some(0),
            _ => None,
        }
    }

    fn scalar_kind(&self, local: Handle<LocalVariable>) -> Option<ScalarKind> {
        match self.scope.module.types[self.scope.function.local_variables[local].ty].inner {
            TypeInner::Scalar(scalar) => Some(scalar.kind),
            _ => None,
        }
    }

    /// What every turn does to a variable that the loop writes these values to, if it is one that ends a loop.
    fn change(&self, local: Handle<LocalVariable>, values: &[Option<Handle<Expression>>]) -> Option<Change> {
        let kind = self.scalar_kind(local).filter(|kind| matches!(kind, ScalarKind::Sint | ScalarKind::Uint))?;
        let values: Vec<_> = values.iter().copied().collect::<Option<_>>()?;
        let every_turn = self.values_of_every_turn(local);
        let loses_bits = |value: &Handle<Expression>| {
            matches!(self.expression(*value), Expression::Binary { op: BinaryOperator::And, left, .. }
                if self.is_load_of(*left, local))
        };
        if values.iter().all(loses_bits) {
            return every_turn.iter().any(|value| self.loses_lowest_bit(*value, local)).then_some(Change::Bits);
        }
        let ([value], [of_every_turn]) = (&values[..], &every_turn[..]) else { return None };
        if value != of_every_turn {
            return None;
        }
        let Expression::Binary { op, left, right } = self.expression(*value) else { return None };
        if !self.is_load_of(*left, local) {
            return None;
        }
        let step = self.literal(*right);
        let is_step = step.map_or_else(|| self.knows(*right), |step| step > 0);
        // A counter that starts anywhere may be far from its end: down from above, or up from below zero.
        let starts_known = !self.known.unknown_locals.contains_key(&(self.scope.id, local.index()));
        let has_floor = || {
            let starts = self.stores[&local].iter().filter(|start| **start != Some(*value));
            starts.copied().all(|start| start.is_some_and(|start| self.has_floor(start)))
        };
        match op {
            BinaryOperator::Add if is_step && (kind == ScalarKind::Uint || starts_known || has_floor()) => {
                Some(Change::Up)
            }
            BinaryOperator::Subtract if is_step && starts_known => Some(Change::Down),
            BinaryOperator::ShiftRight if step > Some(0) && kind == ScalarKind::Uint => Some(Change::Down),
            BinaryOperator::Multiply if step > Some(1) && self.starts_above_zero(local, *value) => Some(Change::Up),
            _ => None,
        }
    }

    /// Whether a number is at least a known one.
    fn has_floor(&self, expression: Handle<Expression>) -> bool {
        self.knows(expression)
            || match self.expression(expression) {
                Expression::Math { fun: MathFunction::Max, arg, arg1: Some(arg1), .. } => {
                    self.knows(*arg) || self.knows(*arg1)
                }
                Expression::AccessIndex { base, .. } => self.has_floor(*base),
                _ => false,
            }
    }

    /// `local & (local − 1)`.
    fn loses_lowest_bit(&self, value: Handle<Expression>, local: Handle<LocalVariable>) -> bool {
        let Expression::Binary { op: BinaryOperator::And, right, .. } = self.expression(value) else { return false };
        matches!(self.expression(*right), Expression::Binary { op: BinaryOperator::Subtract, left, right }
            if self.is_load_of(*left, local) && self.literal(*right) == Some(1))
    }

    fn starts_above_zero(&self, local: Handle<LocalVariable>, step: Handle<Expression>) -> bool {
        let init = self.scope.function.local_variables[local].init;
        let starts = self.stores[&local].iter().copied().filter(|value| *value != Some(step));
        let mut starts: Vec<_> = starts.chain(init.map(Some)).collect();
        starts.dedup();
        !starts.is_empty() && starts.iter().all(|start| start.and_then(|start| self.literal(start)) > Some(0))
    }

    /// What every turn writes to a variable.
    fn values_of_every_turn(&self, local: Handle<LocalVariable>) -> Vec<Handle<Expression>> {
        let met = self.met_every_turn().into_iter().map(|(_, statement)| statement);
        met.chain(self.continuing.iter())
            .filter_map(|statement| match statement {
                Statement::Store { pointer, value } => {
                    matches!(self.expression(*pointer), Expression::LocalVariable(of) if *of == local).then_some(*value)
                }
                _ => None,
            })
            .collect()
    }

    /// The body's statements, with their blocks, as far as no turn can have skipped to the next.
    fn met_every_turn(&self) -> Vec<(&Block, &Statement)> {
        let mut met = Vec::new();
        collect_until_skipped(self.body, &mut met);
        met
    }

    fn has_guard(&self, local: Handle<LocalVariable>, change: Change) -> bool {
        let breaks = |block: &Block| matches!(block.last(), Some(Statement::Break | Statement::Return { .. }));
        let in_body = self.met_every_turn().into_iter().any(|(block, statement)| match statement {
            Statement::If { condition, accept, reject } => {
                (breaks(reject) && self.parts(block, *condition, true, local, change))
                    || (breaks(accept) && self.parts(block, *condition, false, local, change))
            }
            _ => false,
        });
        in_body || self.break_if.is_some_and(|leaves| self.parts(self.continuing, leaves, false, local, change))
    }

    /// Whether a condition to stay has a part, of those that must all hold, that ends the loop by the variable; or one to
    /// leave, of those of which one suffices.
    fn parts(
        &self,
        block: &Block,
        condition: Handle<Expression>,
        stays: bool,
        local: Handle<LocalVariable>,
        change: Change,
    ) -> bool {
        let part = |block: &Block, part: Handle<Expression>, stays: bool| self.parts(block, part, stays, local, change);
        match self.expression(condition) {
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => part(block, *expr, !stays),
            Expression::Binary { op: BinaryOperator::And | BinaryOperator::LogicalAnd, left, right } if stays => {
                part(block, *left, stays) || part(block, *right, stays)
            }
            Expression::Binary { op: BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr, left, right }
                if !stays =>
            {
                part(block, *left, stays) || part(block, *right, stays)
            }
            Expression::Binary { op, left, right } => self.is_guard(*op, *left, *right, stays, local, change),
            // `a && b` is parsed to: if a { v = b } else { v = false }, and `a || b` to: if !a { v = b } else { v = true }.
            Expression::Load { pointer } => {
                let Expression::LocalVariable(result) = self.expression(*pointer) else { return false };
                block.iter().any(|statement| {
                    let Statement::If { condition: first, accept, reject } = statement else { return false };
                    let stored = |block: &Block| match block.last() {
                        Some(Statement::Store { pointer, value })
                            if matches!(self.expression(*pointer), Expression::LocalVariable(of) if of == result) =>
                        {
                            Some(*value)
                        }
                        _ => None,
                    };
                    let (Some(second), Some(otherwise)) = (stored(accept), stored(reject)) else { return false };
                    let is_and = match self.expression(otherwise) {
                        Expression::Literal(Literal::Bool(otherwise)) => !otherwise,
                        _ => return false,
                    };
                    // Of `a || b` the negation of the first stands there.
                    is_and == stays && (part(block, *first, true) || part(accept, second, stays))
                })
            }
            _ => false,
        }
    }

    /// Whether a comparison, of which the loop goes on where it `stays` true, ends it.
    fn is_guard(
        &self,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
        stays: bool,
        local: Handle<LocalVariable>,
        change: Change,
    ) -> bool {
        use BinaryOperator::{Equal, Greater, GreaterEqual, Less, LessEqual, NotEqual};
        let negated = |op| match op {
            Less => GreaterEqual,
            LessEqual => Greater,
            Greater => LessEqual,
            GreaterEqual => Less,
            Equal => NotEqual,
            NotEqual => Equal,
            other => other,
        };
        let mirrored = |op| match op {
            Less => Greater,
            LessEqual => GreaterEqual,
            Greater => Less,
            GreaterEqual => LessEqual,
            other => other,
        };
        let op = if stays { op } else { negated(op) };
        let (op, counter, limit) =
            if self.grows_with(left, local) { (op, left, right) } else { (mirrored(op), right, left) };
        if !self.grows_with(counter, local) {
            return false;
        }
        match (change, op) {
            (Change::Up, Less | LessEqual) | (Change::Down, Greater) => self.knows(limit),
            // Down to zero by steps that may jump over it: none do, as a shift ends there, and a step of 1.
            (Change::Bits | Change::Down, NotEqual) | (Change::Bits, Greater) => {
                self.is_load_of(counter, local) && self.literal(limit) == Some(0)
            }
            _ => false,
        }
    }

    /// The variable, or a known multiple of it, or that and more.
    fn grows_with(&self, expression: Handle<Expression>, local: Handle<LocalVariable>) -> bool {
        self.is_load_of(expression, local)
            || matches!(self.expression(expression),
                Expression::Binary { op: BinaryOperator::Add | BinaryOperator::Multiply, left, right }
                    if (self.grows_with(*left, local) && self.knows(*right))
                        || (self.grows_with(*right, local) && self.knows(*left)))
    }
}

/// Returns whether a turn may have skipped to the next.
fn collect_until_skipped<'a>(block: &'a Block, met: &mut Vec<(&'a Block, &'a Statement)>) -> bool {
    for statement in block.iter() {
        if let Statement::Block(inner) = statement {
            if collect_until_skipped(inner, met) {
                return true;
            }
            continue;
        }
        met.push((block, statement));
        if skips_on(statement) {
            return true;
        }
    }
    false
}

/// Whether a statement may go on with the loop's next turn.
fn skips_on(statement: &Statement) -> bool {
    match statement {
        Statement::Continue => true,
        Statement::Loop { .. } => false,
        _ => inner_blocks(statement).into_iter().any(|block| block.iter().any(skips_on)),
    }
}
