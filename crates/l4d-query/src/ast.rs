//! The predicate language: its JSON form, what is well formed, and the category that follows from a predicate.
//!
//! A predicate is a list of clauses that must all hold of the referent:
//!
//! ```json
//! [{"category": "bucket"}, {"undergoes": {"verb": "lift", "by": {"such": [{"category": "woman"}, {"does": {"verb": "wave"}}]}}}]
//! ```
//!
//! The first clause names the kind of thing; the others discriminate it from its look-alikes. `docs/queries.md`
//! defines every clause.

use l4d_data::{Category, Name};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Deepest nesting of clauses and parties that a predicate may have.
const MAX_DEPTH: usize = 6;
/// Most clauses of a predicate or party.
const MAX_CLAUSES: usize = 8;

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
    Attribute { key: String, value: String },
    /// It acts: `{"does": {"verb": "walk"}}`, or upon something: `{"does": {"verb": "lift", "to": {...}}}`.
    Does {
        verb: String,
        /// To whom; left out for actions.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<Party>,
    },
    /// Something is done to it: the passive of `does` with a second role.
    Undergoes { verb: String, by: Party },
    /// It is in a geometric relation.
    Relation {
        kind: Relation,
        /// To these (two for `between`, otherwise one).
        of: Vec<Party>,
    },
    /// It is the extreme of its category.
    Superlative(Superlative),
    /// The clause inside does not hold.
    Not(Box<Clause>),
    /// The clause inside holds at the first frame of the clip.
    AtStart(Box<Clause>),
    /// The clause inside holds at the last frame of the clip.
    AtEnd(Box<Clause>),
    /// Of its category it is the first that does what the clause inside says.
    First(Box<Clause>),
    /// Of its category it is the last that begins to do what the clause inside says.
    Last(Box<Clause>),
    /// It does the one and later the other.
    Then(Box<[Clause; 2]>),
}

/// The other role of an interaction or relation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Party {
    Name(Name),
    /// Any instance of this category.
    Category(String),
    /// Whom this describes; what it says of events holds at some time, what it says of states all the time.
    Such(Predicate),
}

/// Relations that geometry decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// Rests on it.
    On,
    /// Inside it.
    In,
    /// Below its top, inside its footprint.
    Under,
    /// Within arm's reach of it, but not on or in it.
    Beside,
    /// In contact with it.
    Touching,
    /// Between two others, in plan view.
    Between,
    /// Nearer to it than any other of its category.
    ClosestTo,
    /// Farther from it than any other of its category.
    FarthestFrom,
    /// Where the front of the other points.
    InFrontOf,
    /// Where the back of the other points.
    Behind,
    /// Its front points at the other.
    Facing,
}

/// Extremes among a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Superlative {
    /// Its box has the largest volume.
    Largest,
    /// Its box has the smallest volume.
    Smallest,
    /// Its box is the tallest.
    Tallest,
    /// The centre of its box is highest above the ground.
    Highest,
    /// The centre of its box is lowest.
    Lowest,
}

impl Relation {
    pub const ALL: [Self; 11] = [
        Self::On,
        Self::In,
        Self::Under,
        Self::Beside,
        Self::Touching,
        Self::Between,
        Self::ClosestTo,
        Self::FarthestFrom,
        Self::InFrontOf,
        Self::Behind,
        Self::Facing,
    ];

    /// How many others it relates to.
    pub fn arity(self) -> usize {
        if self == Self::Between { 2 } else { 1 }
    }
}

impl Superlative {
    /// Largest, smallest and tallest are properties; highest and lowest are places.
    pub fn category(self) -> Category {
        match self {
            Self::Largest | Self::Smallest | Self::Tallest => Category::Attribute,
            Self::Highest | Self::Lowest => Category::Spatial,
        }
    }
}

impl Predicate {
    /// Reads the JSON form.
    ///
    /// # Errors
    /// What is no predicate of the language.
    pub fn from_json(value: &Value) -> Result<Self, String> {
        let predicate: Self = serde_json::from_value(value.clone()).map_err(|error| error.to_string())?;
        if predicate.0.len() == 1 && matches!(predicate.0[0], Clause::Category(_)) {
            return Err("has no clause that discriminates: add one after the category".into());
        }
        predicate.well_formed(0)?;
        Ok(predicate)
    }

    /// The noun of the first clause.
    pub fn noun(&self) -> &str {
        match self.0.first() {
            Some(Clause::Category(noun)) => noun,
            _ => "",
        }
    }

    /// The clauses after the noun.
    pub fn discriminating(&self) -> impl Iterator<Item = &Clause> {
        self.0.iter().filter(|clause| !matches!(clause, Clause::Category(_)))
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

    /// The others that it mentions, at every depth.
    pub fn parties(&self) -> Vec<&Party> {
        self.clauses().into_iter().flat_map(Clause::own_parties).collect()
    }

    /// All clauses at every depth, outermost first.
    pub fn clauses(&self) -> Vec<&Clause> {
        let mut clauses = Vec::new();
        for clause in &self.0 {
            clause.collect_clauses(&mut clauses);
        }
        clauses
    }

    fn well_formed(&self, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("is nested deeper than {MAX_DEPTH} levels: too many to follow"));
        }
        if self.0.len() > MAX_CLAUSES {
            return Err(format!("has more than {MAX_CLAUSES} clauses: too many to follow"));
        }
        let Some((Clause::Category(_), rest)) = self.0.split_first() else {
            return Err("must start with a category clause".into());
        };
        rest.iter().try_for_each(|clause| clause.well_formed(depth + 1))
    }
}

impl Clause {
    /// The kind of reasoning; none for the noun.
    pub fn category(&self) -> Option<Category> {
        match self {
            Self::Category(_) => None,
            Self::Attribute { .. } => Some(Category::Attribute),
            Self::Superlative(extreme) => Some(extreme.category()),
            Self::Does { to: None, .. } => Some(Category::Action),
            Self::Does { to: Some(_), .. } | Self::Undergoes { .. } => Some(Category::Interaction),
            Self::Relation { .. } => Some(Category::Spatial),
            Self::Not(inner)
            | Self::AtStart(inner)
            | Self::AtEnd(inner)
            | Self::First(inner)
            | Self::Last(inner) => inner.category(),
            Self::Then(steps) => steps.iter().filter_map(Self::category).max(),
        }
    }

    /// Whether it speaks of something that happens: over a clip, "at some time" is meant, not "all the time".
    pub fn is_event(&self) -> bool {
        match self {
            Self::Does { .. } | Self::Undergoes { .. } => true,
            Self::Not(inner) => inner.is_event(),
            _ => false,
        }
    }

    /// Whether its truth is a matter of the whole clip rather than of a frame.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Category(_) | Self::Attribute { .. } => true,
            Self::Superlative(extreme) => extreme.category() == Category::Attribute,
            Self::AtStart(_) | Self::AtEnd(_) | Self::First(_) | Self::Last(_) | Self::Then(_) => true,
            Self::Not(inner) => inner.is_constant(),
            Self::Does { .. } | Self::Undergoes { .. } | Self::Relation { .. } => false,
        }
    }

    /// The clauses directly inside.
    pub fn inner(&self) -> &[Clause] {
        match self {
            Self::Not(inner)
            | Self::AtStart(inner)
            | Self::AtEnd(inner)
            | Self::First(inner)
            | Self::Last(inner) => std::slice::from_ref(inner),
            Self::Then(steps) => steps.as_slice(),
            _ => &[],
        }
    }

    /// The others that it mentions itself, without those of clauses inside.
    pub fn own_parties(&self) -> &[Party] {
        match self {
            Self::Does { to: Some(party), .. } | Self::Undergoes { by: party, .. } => {
                std::slice::from_ref(party)
            }
            Self::Relation { of, .. } => of,
            _ => &[],
        }
    }

    fn collect_clauses<'c>(&'c self, clauses: &mut Vec<&'c Clause>) {
        clauses.push(self);
        for party in self.own_parties() {
            if let Party::Such(predicate) = party {
                predicate.0.iter().for_each(|clause| clause.collect_clauses(clauses));
            }
        }
        self.inner().iter().for_each(|clause| clause.collect_clauses(clauses));
    }

    fn well_formed(&self, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("is nested deeper than {MAX_DEPTH} levels: too many to follow"));
        }
        let is_plain_event = |clause: &Self| matches!(clause, Self::Does { .. } | Self::Undergoes { .. });
        match self {
            Self::Category(_) => return Err("a category clause may only stand first".into()),
            Self::Relation { kind, of } if of.len() != kind.arity() => {
                return Err(format!("`{kind}` takes {} of them, not {}", kind.arity(), of.len()));
            }
            Self::First(inner) | Self::Last(inner) if !is_plain_event(inner) => {
                return Err("`first` and `last` take `does` or `undergoes`".into());
            }
            Self::Then(steps) if !steps.iter().all(is_plain_event) => {
                return Err("`then` takes two of `does` or `undergoes`".into());
            }
            Self::AtStart(inner) | Self::AtEnd(inner) if inner.is_constant() => {
                return Err("`at_start` and `at_end` take what can change: a relation or an event".into());
            }
            _ => {}
        }
        for party in self.own_parties() {
            if let Party::Such(predicate) = party {
                predicate.well_formed(depth + 1)?;
            }
        }
        self.inner().iter().try_for_each(|clause| clause.well_formed(depth + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Predicate, String> {
        Predicate::from_json(&serde_json::from_str(text).unwrap())
    }

    #[test]
    fn every_clause_round_trips() {
        let clauses = [
            r#"{"attribute":{"key":"colour","value":"red"}}"#,
            r#"{"does":{"verb":"walk"}}"#,
            r#"{"does":{"verb":"lift","to":{"category":"bucket"}}}"#,
            r#"{"undergoes":{"verb":"lift","by":{"such":[{"category":"woman"},{"does":{"verb":"wave"}}]}}}"#,
            r#"{"relation":{"kind":"between","of":[{"name":"well"},{"category":"fence"}]}}"#,
            r#"{"superlative":"highest"}"#,
            r#"{"not":{"relation":{"kind":"in_front_of","of":[{"name":"well"}]}}}"#,
            r#"{"at_start":{"relation":{"kind":"on","of":[{"name":"well"}]}}}"#,
            r#"{"at_end":{"superlative":"lowest"}}"#,
            r#"{"first":{"does":{"verb":"walk"}}}"#,
            r#"{"last":{"does":{"verb":"walk"}}}"#,
            r#"{"then":[{"does":{"verb":"walk"}},{"does":{"verb":"sit"}}]}"#,
        ];
        for clause in clauses {
            let text = format!(r#"[{{"category":"bucket"}},{clause}]"#);
            assert_eq!(serde_json::to_string(&parse(&text).unwrap()).unwrap(), text);
        }
    }

    #[test]
    fn categories_follow_from_clauses() {
        let cases = [
            (r#"{"superlative":"largest"}"#, Category::Attribute),
            (r#"{"superlative":"lowest"}"#, Category::Spatial),
            (r#"{"at_end":{"relation":{"kind":"on","of":[{"name":"a"}]}}}"#, Category::Spatial),
            (r#"{"first":{"does":{"verb":"walk"}}}"#, Category::Action),
            (r#"{"not":{"undergoes":{"verb":"lift","by":{"name":"a"}}}}"#, Category::Interaction),
            (
                r#"{"then":[{"does":{"verb":"walk"}},{"does":{"verb":"lift","to":{"name":"a"}}}]}"#,
                Category::Interaction,
            ),
            (r#"{"then":[{"does":{"verb":"walk"}},{"does":{"verb":"sit"}}]}"#, Category::Action),
        ];
        for (clause, category) in cases {
            let predicate = parse(&format!(r#"[{{"category":"x"}},{clause}]"#)).unwrap();
            assert_eq!(predicate.categories(), [category], "{clause}");
        }
    }

    #[test]
    fn nonsense_is_refused_with_a_reason() {
        let cases = [
            (r#"[{"category":"bucket"}]"#, "discriminates"),
            (r#"[{"attribute":{"key":"colour","value":"red"}}]"#, "category clause"),
            (r#"[]"#, "category clause"),
            (r#"[{"category":"a"},{"category":"b"}]"#, "only stand first"),
            (r#"[{"category":"a"},{"relation":{"kind":"left_of","of":[{"name":"a"}]}}]"#, "left_of"),
            (r#"[{"category":"a"},{"relation":{"kind":"between","of":[{"name":"a"}]}}]"#, "takes 2"),
            (r#"[{"category":"a"},{"relation":{"kind":"on","of":["table"]}}]"#, "variant"),
            (r#"[{"category":"a"},{"first":{"superlative":"highest"}}]"#, "`first`"),
            (r#"[{"category":"a"},{"then":[{"does":{"verb":"walk"}}]}]"#, "length"),
            (r#"[{"category":"a"},{"at_end":{"attribute":{"key":"colour","value":"red"}}}]"#, "can change"),
            (r#"[{"category":"a"},{"undergoes":{"verb":"lift","by":{"such":[]}}}]"#, "category clause"),
            (r#"[{"category":"a"},{"does":{"verb":"lift","too":{"name":"a"}}}]"#, "too"),
        ];
        for (text, reason) in cases {
            let message = parse(text).unwrap_err();
            assert!(message.contains(reason), "{text}: {message}");
        }
        let deep = format!(
            r#"[{{"category":"a"}},{}{{"does":{{"verb":"walk"}}}}{}]"#,
            r#"{"not":"#.repeat(9),
            "}".repeat(9)
        );
        assert!(parse(&deep).unwrap_err().contains("nested"));
    }
}
