//! Which nouns name kinds of others: a woman is a person, too.

/// A noun and those that name kinds of it.
const KINDS: &[(&str, &str)] = &[
    (
        "person",
        "woman man child girl boy baby cook chef waiter waitress athlete gymnast runner dancer pedestrian \
         walker cyclist skater player teacher student pupil gardener farmer worker barista painter musician",
    ),
    ("child", "girl boy baby"),
    ("animal", "cat dog duck horse bird rabbit fish cow sheep goat hen chicken squirrel fox"),
    ("bird", "duck hen chicken"),
    ("vehicle", "car truck van bus bicycle motorcycle scooter tractor"),
];

/// The nouns that name kinds of this one.
pub(crate) fn kinds_of(noun: &str) -> impl Iterator<Item = &'static str> {
    let lists = KINDS.iter().filter(move |(parent, _)| *parent == noun);
    lists.flat_map(|(_, kinds)| kinds.split_whitespace())
}

/// The nouns of which this one names a kind.
pub(crate) fn parents_of(noun: &str) -> impl Iterator<Item = &'static str> {
    let lists = KINDS.iter().filter(move |(_, kinds)| kinds.split_whitespace().any(|kind| kind == noun));
    lists.map(|(parent, _)| *parent)
}
