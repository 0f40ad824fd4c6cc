//! Places where a shader's source can be changed: operators, comparisons and numbers, found in its syntax tree.
//!
//! - Arithmetic operators become their opposites: + and −, · and /, also in assignments; likewise `&&` and `||`, `&` and `|`,
//!   `<<` and `>>`.
//! - A comparison becomes its negation. Its boundary (`<` for `<=`) affects one of billions of float values, which no test
//!   can be expected to hit. Therefore it changes only in loop conditions, which compare integers.
//! - A float becomes 0 and twice itself; 0 becomes 1. An integer is increased by one.
//!
//! Attributes, types and digits in names are left alone: they are the interface to Rust, which has its own tests.

use wesl::syntax::{
    AssignmentOperator, BinaryOperator, CaseSelector, CompoundStatement, Expression, ExpressionNode, GlobalDeclaration,
    LiteralExpression, Statement, TranslationUnit,
};

/// Change of a source: the bytes from `start` to `end` are replaced by `to`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    pub start: usize,
    pub end: usize,
    pub to: String,
}

/// Returns every change of a source. They are made one at a time, and some places have two.
///
/// # Errors
/// If the source is not WESL.
pub fn changes_of(source: &str) -> Result<Vec<Change>, String> {
    let tree: TranslationUnit = source.parse().map_err(|error| format!("{error}"))?;
    let mut places = Places { source, changes: Vec::new() };
    for declaration in &tree.global_declarations {
        match declaration.node() {
            GlobalDeclaration::Declaration(declaration) => places.maybe(declaration.initializer.as_ref()),
            GlobalDeclaration::Function(function) => places.block(&function.body),
            _ => {}
        }
    }
    places.changes.sort_by_key(|change| change.start);
    Ok(places.changes)
}

struct Places<'a> {
    source: &'a str,
    changes: Vec<Change>,
}

impl Places<'_> {
    fn block(&mut self, block: &CompoundStatement) {
        for statement in &block.statements {
            self.statement(statement.node());
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Compound(block) => self.block(block),
            Statement::Assignment(assignment) => {
                let between = assignment.lhs.span().end..assignment.rhs.span().start;
                if let Some((from, to)) = opposite_assignment(assignment.operator) {
                    self.operator(between, from, to);
                }
                self.expression(&assignment.lhs);
                self.expression(&assignment.rhs);
            }
            Statement::If(choice) => {
                self.expression(&choice.if_clause.expression);
                self.block(&choice.if_clause.body);
                for clause in &choice.else_if_clauses {
                    self.expression(&clause.expression);
                    self.block(&clause.body);
                }
                if let Some(clause) = &choice.else_clause {
                    self.block(&clause.body);
                }
            }
            Statement::Switch(switch) => {
                self.expression(&switch.expression);
                for clause in &switch.clauses {
                    for selector in &clause.case_selectors {
                        if let CaseSelector::Expression(selector) = selector {
                            self.expression(selector);
                        }
                    }
                    self.block(&clause.body);
                }
            }
            Statement::Loop(endless) => {
                self.block(&endless.body);
                if let Some(continuing) = &endless.continuing {
                    self.block(&continuing.body);
                    self.maybe(continuing.break_if.as_ref().map(|end| &end.expression));
                }
            }
            Statement::For(counted) => {
                for part in [&counted.initializer, &counted.update].into_iter().flatten() {
                    self.statement(part.node());
                }
                if let Some(condition) = &counted.condition {
                    self.loop_condition(condition);
                }
                self.block(&counted.body);
            }
            Statement::While(endless) => {
                self.loop_condition(&endless.condition);
                self.block(&endless.body);
            }
            Statement::Return(end) => self.maybe(end.expression.as_ref()),
            Statement::FunctionCall(statement) => self.all(&statement.call.arguments),
            Statement::Declaration(declaration) => self.maybe(declaration.initializer.as_ref()),
            _ => {}
        }
    }

    fn maybe(&mut self, expression: Option<&ExpressionNode>) {
        expression.into_iter().for_each(|expression| self.expression(expression));
    }

    fn all(&mut self, expressions: &[ExpressionNode]) {
        expressions.iter().for_each(|expression| self.expression(expression));
    }

    /// Visits a loop condition: as any expression, and also the boundary of its comparison, if it is one.
    fn loop_condition(&mut self, condition: &ExpressionNode) {
        if let Expression::Binary(binary) = condition.node() {
            let to = match binary.operator {
                BinaryOperator::LessThan => "<=",
                BinaryOperator::LessThanEqual => "<",
                BinaryOperator::GreaterThan => ">=",
                BinaryOperator::GreaterThanEqual => ">",
                _ => "",
            };
            if !to.is_empty() {
                let between = binary.left.span().end..binary.right.span().start;
                self.operator(between, &binary.operator.to_string(), to);
            }
        }
        self.expression(condition);
    }

    fn expression(&mut self, expression: &ExpressionNode) {
        match expression.node() {
            Expression::Literal(literal) => self.number(expression, literal),
            Expression::Parenthesized(inner) => self.expression(&inner.expression),
            Expression::NamedComponent(component) => self.expression(&component.base),
            Expression::Indexing(indexing) => {
                self.expression(&indexing.base);
                self.expression(&indexing.index);
            }
            Expression::Unary(unary) => self.expression(&unary.operand),
            Expression::Binary(binary) => {
                if let Some(to) = opposite(binary.operator) {
                    let between = binary.left.span().end..binary.right.span().start;
                    self.operator(between, &binary.operator.to_string(), to);
                }
                self.expression(&binary.left);
                self.expression(&binary.right);
            }
            Expression::FunctionCall(call) => self.all(&call.arguments),
            Expression::TypeOrIdentifier(_) => {}
        }
    }

    /// Adds the change of an operator somewhere between its operands.
    fn operator(&mut self, between: std::ops::Range<usize>, from: &str, to: &str) {
        let found = self.source.get(between.clone()).and_then(|text| text.find(from));
        let Some(start) = found.map(|at| between.start + at) else { return };
        self.changes.push(Change { start, end: start + from.len(), to: to.to_owned() });
    }

    fn number(&mut self, expression: &ExpressionNode, literal: &LiteralExpression) {
        let span = expression.span();
        let others: Vec<String> = match *literal {
            LiteralExpression::AbstractFloat(0.0) => vec!["1.0".to_owned()],
            LiteralExpression::AbstractFloat(value) => vec!["0.0".to_owned(), format!("{:?}", 2.0 * value)],
            LiteralExpression::AbstractInt(value) => vec![(value + 1).to_string()],
            LiteralExpression::I32(value) => vec![format!("{}i", value.wrapping_add(1))],
            LiteralExpression::U32(value) => vec![format!("{}u", value.wrapping_add(1))],
            _ => Vec::new(),
        };
        let changes = others.into_iter().map(|to| Change { start: span.start, end: span.end, to });
        self.changes.extend(changes);
    }
}

fn opposite(operator: BinaryOperator) -> Option<&'static str> {
    Some(match operator {
        BinaryOperator::Addition => "-",
        BinaryOperator::Subtraction => "+",
        BinaryOperator::Multiplication => "/",
        BinaryOperator::Division | BinaryOperator::Remainder => "*",
        BinaryOperator::Equality => "!=",
        BinaryOperator::Inequality => "==",
        BinaryOperator::LessThan => ">=",
        BinaryOperator::LessThanEqual => ">",
        BinaryOperator::GreaterThan => "<=",
        BinaryOperator::GreaterThanEqual => "<",
        BinaryOperator::ShortCircuitOr => "&&",
        BinaryOperator::ShortCircuitAnd => "||",
        BinaryOperator::BitwiseOr => "&",
        BinaryOperator::BitwiseAnd => "|",
        BinaryOperator::ShiftLeft => ">>",
        BinaryOperator::ShiftRight => "<<",
        BinaryOperator::BitwiseXor => return None,
    })
}

fn opposite_assignment(operator: AssignmentOperator) -> Option<(&'static str, &'static str)> {
    Some(match operator {
        AssignmentOperator::PlusEqual => ("+=", "-="),
        AssignmentOperator::MinusEqual => ("-=", "+="),
        AssignmentOperator::TimesEqual => ("*=", "/="),
        AssignmentOperator::DivisionEqual => ("/=", "*="),
        AssignmentOperator::OrEqual => ("|=", "&="),
        AssignmentOperator::AndEqual => ("&=", "|="),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(source: &str) -> Vec<String> {
        let apply = |change: &Change| {
            let mut text = source.to_owned();
            text.replace_range(change.start..change.end, &change.to);
            text
        };
        changes_of(source).expect("a source").iter().map(apply).collect()
    }

    #[test]
    fn operators_comparisons_and_numbers_change_and_nothing_else() {
        let source =
            "@group(0) @binding(1) var<uniform> u: vec4f; // 1 + 1\nfn f(a: f32) -> bool { return a * 3.0 < u.x; }";
        let expected = ["a / 3.0 < u.x", "a * 0.0 < u.x", "a * 6.0 < u.x", "a * 3.0 >= u.x"];
        assert_eq!(changed(source), expected.map(|to| source.replace("a * 3.0 < u.x", to)));
    }

    #[test]
    fn loops_have_their_boundary_changed() {
        let source = "fn f(n: u32) { for (var i = 0u; i < n; i++) { g(i) ; } }";
        let expected = ["var i = 1u; i < n", "var i = 0u; i <= n", "var i = 0u; i >= n"];
        assert_eq!(changed(source), expected.map(|to| source.replace("var i = 0u; i < n", to)));
    }

    #[test]
    fn what_assigns_changes_too() {
        let source = "fn f(a: u32) { var b = a; b |= a; b = b % a; }";
        assert_eq!(changed(source), [source.replace("|=", "&="), source.replace('%', "*")]);
    }
}
