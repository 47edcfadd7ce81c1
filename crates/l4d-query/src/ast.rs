//! The predicate language: JSON form, text form, and the category that follows from a predicate.
//!
//! A predicate is a list of clauses that must all hold of the referent:
//!
//! ```json
//! [{"category": "bucket"}, {"relation": {"kind": "between", "of": ["bucket_red", "bucket_blue"]}}]
//! ```
//!
//! The first clause names the kind of thing; the others discriminate it from its look-alikes.

use std::fmt;

use l4d_data::{Category, Name};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Clauses that must all hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Predicate(pub Vec<Clause>);

/// One condition on an instance.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Clause {
    /// Its category is this noun.
    Category(String),
    /// A visible property has this value.
    Attribute {
        /// Property ("colour").
        key: String,
        /// Value ("red").
        value: String,
    },
    /// It acts: `{"does": {"verb": "walk"}}`, or upon something: `{"does": {"verb": "lift", "to": {...}}}`.
    Does {
        /// Base form.
        verb: String,
        /// To whom; left out for actions.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<Party>,
    },
    /// Something is done to it: the passive of `does` with a second role.
    Undergoes {
        /// Base form.
        verb: String,
        /// By whom.
        by: Party,
    },
    /// It stands in a geometric relation.
    Relation {
        /// Which.
        kind: Relation,
        /// To these instances (two for `between`, otherwise one).
        of: Vec<Name>,
    },
    /// The clause inside does not hold.
    Not(Box<Clause>),
}

/// The other role of an interaction.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Party {
    /// This instance.
    Name(Name),
    /// Any instance of this category.
    Category(String),
}

/// Relations that geometry decides (definitions: [`crate::world::World::related`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// Rests on it.
    On,
    /// Below its top, inside its footprint.
    Under,
    /// Within arm's reach of it, and not on it.
    Beside,
    /// Between two others, in plan view.
    Between,
    /// Nearer to it than any other of its category.
    ClosestTo,
}

impl Predicate {
    /// Reads the JSON form.
    pub fn from_json(value: &Value) -> Result<Self, String> {
        let predicate: Self = serde_json::from_value(value.clone()).map_err(|error| error.to_string())?;
        match predicate.0.first() {
            Some(Clause::Category(_)) if predicate.0.len() >= 2 => Ok(predicate),
            Some(Clause::Category(_)) => {
                Err("has no clause that discriminates: add one after the category".into())
            }
            _ => Err("must start with a category clause".into()),
        }
    }

    /// The noun of the first clause.
    pub fn noun(&self) -> &str {
        match self.0.first() {
            Some(Clause::Category(noun)) => noun,
            _ => "",
        }
    }

    /// The kinds of reasoning that its discriminating clauses ask for, in table order.
    pub fn categories(&self) -> Vec<Category> {
        let present: Vec<Category> = self.0.iter().filter_map(Clause::category).collect();
        Category::ALL.into_iter().filter(|category| present.contains(category)).collect()
    }

    /// The predicate without its clauses of one category.
    pub fn without(&self, category: Category) -> Self {
        Self(self.0.iter().filter(|clause| clause.category() != Some(category)).cloned().collect())
    }

    /// Names of instances that it mentions.
    pub fn mentions(&self) -> Vec<&Name> {
        self.0.iter().flat_map(Clause::mentions).collect()
    }
}

impl Clause {
    /// The kind of reasoning; none for the noun.
    pub fn category(&self) -> Option<Category> {
        match self {
            Self::Category(_) => None,
            Self::Attribute { .. } => Some(Category::Attribute),
            Self::Does { to: None, .. } => Some(Category::Action),
            Self::Does { to: Some(_), .. } | Self::Undergoes { .. } => Some(Category::Interaction),
            Self::Relation { .. } => Some(Category::Spatial),
            Self::Not(inner) => inner.category(),
        }
    }

    /// Whether it speaks of something that happens, rather than of a state.
    pub fn is_event(&self) -> bool {
        match self {
            Self::Does { .. } | Self::Undergoes { .. } => true,
            Self::Not(inner) => inner.is_event(),
            _ => false,
        }
    }

    fn mentions(&self) -> Vec<&Name> {
        match self {
            Self::Does { to: Some(Party::Name(name)), .. }
            | Self::Undergoes { by: Party::Name(name), .. } => vec![name],
            Self::Relation { of, .. } => of.iter().collect(),
            Self::Not(inner) => inner.mentions(),
            _ => Vec::new(),
        }
    }
}

impl fmt::Display for Predicate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let clauses: Vec<String> = self.0.iter().map(Clause::to_string).collect();
        formatter.write_str(&clauses.join(" and "))
    }
}

impl fmt::Display for Clause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Category(noun) => write!(formatter, "{noun}(x)"),
            Self::Attribute { key, value } => write!(formatter, "{key}(x) = {value}"),
            Self::Does { verb, to: None } => write!(formatter, "{verb}(x)"),
            Self::Does { verb, to: Some(party) } => write!(formatter, "{verb}(x, {party})"),
            Self::Undergoes { verb, by } => write!(formatter, "{verb}({by}, x)"),
            Self::Relation { kind, of } => {
                let of: Vec<&str> = of.iter().map(Name::as_str).collect();
                write!(formatter, "{kind}(x, {})", of.join(", "))
            }
            Self::Not(inner) => write!(formatter, "not {inner}"),
        }
    }
}

impl fmt::Display for Party {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(formatter, "{name}"),
            Self::Category(noun) => write!(formatter, "any {noun}"),
        }
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::On => "on",
            Self::Under => "under",
            Self::Beside => "beside",
            Self::Between => "between",
            Self::ClosestTo => "closest_to",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Predicate, String> {
        Predicate::from_json(&serde_json::from_str(text).unwrap())
    }

    #[test]
    fn json_and_text_forms_agree() {
        let text = r#"[{"category":"bucket"},{"undergoes":{"verb":"lift","by":{"name":"woman_pink"}}},{"not":{"relation":{"kind":"beside","of":["well"]}}}]"#;
        let predicate = parse(text).unwrap();
        assert_eq!(serde_json::to_string(&predicate).unwrap(), text);
        assert_eq!(predicate.to_string(), "bucket(x) and lift(woman_pink, x) and not beside(x, well)");
        assert_eq!(predicate.categories(), [Category::Spatial, Category::Interaction]);
    }

    #[test]
    fn a_predicate_needs_a_noun_and_something_that_discriminates() {
        assert!(parse(r#"[{"category":"bucket"}]"#).unwrap_err().contains("discriminates"));
        assert!(
            parse(r#"[{"attribute":{"key":"colour","value":"red"}}]"#)
                .unwrap_err()
                .contains("category clause")
        );
        assert!(parse(r#"[{"category":"bucket"},{"relation":{"kind":"left_of","of":["a"]}}]"#).is_err());
    }
}
