//! The text form of a predicate: `bucket(x) and lift(the y: woman(y) and wave(y), x)`.

use std::fmt;

use serde::Serialize as _;

use crate::ast::{Clause, Party, Predicate, Relation, Superlative};

/// Variables by depth.
const VARIABLES: [&str; 8] = ["x", "y", "z", "u", "v", "w", "s", "t"];

impl fmt::Display for Predicate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&predicate(self, 0))
    }
}

impl fmt::Display for Clause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&clause(self, 0))
    }
}

impl fmt::Display for Party {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&party(self, 0))
    }
}

/// The name in JSON.
impl fmt::Display for Relation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(formatter)
    }
}

/// The name in JSON.
impl fmt::Display for Superlative {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(formatter)
    }
}

fn predicate(predicate: &Predicate, depth: usize) -> String {
    let clauses: Vec<String> = predicate.0.iter().map(|inner| clause(inner, depth)).collect();
    clauses.join(" and ")
}

fn clause(this: &Clause, depth: usize) -> String {
    let x = VARIABLES[depth.min(VARIABLES.len() - 1)];
    match this {
        Clause::Category(noun) => format!("{noun}({x})"),
        Clause::Attribute { key, value } => format!("{key}({x}) = {value}"),
        Clause::Does { verb, to: None } => format!("{verb}({x})"),
        Clause::Does { verb, to: Some(to) } => format!("{verb}({x}, {})", party(to, depth)),
        Clause::Undergoes { verb, by } => format!("{verb}({}, {x})", party(by, depth)),
        Clause::Relation { kind, of } => {
            let of: Vec<String> = of.iter().map(|other| party(other, depth)).collect();
            format!("{kind}({x}, {})", of.join(", "))
        }
        Clause::Superlative(extreme) => format!("{extreme}({x})"),
        Clause::Not(inner) => format!("not {}", clause(inner, depth)),
        Clause::AtStart(inner) => format!("at the start {}", clause(inner, depth)),
        Clause::AtEnd(inner) => format!("at the end {}", clause(inner, depth)),
        Clause::First(inner) => format!("first {}", clause(inner, depth)),
        Clause::Last(inner) => format!("last {}", clause(inner, depth)),
        Clause::Then(steps) => {
            format!("{} then {}", clause(&steps[0], depth), clause(&steps[1], depth))
        }
    }
}

fn party(this: &Party, depth: usize) -> String {
    match this {
        Party::Name(name) => name.to_string(),
        Party::Category(noun) => format!("any {noun}"),
        Party::Such(description) => {
            let y = VARIABLES[(depth + 1).min(VARIABLES.len() - 1)];
            format!("the {y}: {}", predicate(description, depth + 1))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_form_reads_like_logic() {
        let text = r#"[{"category":"bucket"},{"undergoes":{"verb":"lift","by":{"such":[{"category":"woman"},{"not":{"does":{"verb":"wave"}}}]}}},{"at_end":{"relation":{"kind":"beside","of":[{"name":"well"}]}}}]"#;
        let predicate = Predicate::from_json(&serde_json::from_str(text).unwrap()).unwrap();
        assert_eq!(
            predicate.to_string(),
            "bucket(x) and lift(the y: woman(y) and not wave(y), x) and at the end beside(x, well)"
        );
    }
}
