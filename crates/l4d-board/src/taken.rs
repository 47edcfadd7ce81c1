//! What methods took for the thing that was meant: look-alikes, other things, nothing.

use l4d_data::results::Track;
use l4d_data::{Name, Query, Role};

use crate::detail::{AskedScene, Detail, Details, Thing};
use crate::rank::Board;

/// What the instance that a prediction overlaps most is to the query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice {
    /// It is meant, and nothing else is overlapped as much.
    Meant,
    /// It is meant, and something else is overlapped as much: neither was chosen.
    Tied,
    /// Another object of the category of what is meant.
    LookAlike,
    /// An object of another category.
    OtherObject,
    /// A thing that is never meant.
    Landmark,
    /// Nothing annotated is overlapped, or nothing was marked.
    Nothing,
}

impl Choice {
    /// In the order of bars and columns.
    pub(crate) const ALL: [Self; 6] =
        [Self::Meant, Self::Tied, Self::LookAlike, Self::OtherObject, Self::Landmark, Self::Nothing];

    /// In files.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Meant => "meant",
            Self::Tied => "tied",
            Self::LookAlike => "look_alike",
            Self::OtherObject => "other_object",
            Self::Landmark => "landmark",
            Self::Nothing => "nothing",
        }
    }

    /// For people.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Meant => "the one meant",
            Self::Tied => "undecided",
            Self::LookAlike => "a look-alike",
            Self::OtherObject => "another object",
            Self::Landmark => "a landmark",
            Self::Nothing => "nothing",
        }
    }
}

/// One query and what was taken.
#[derive(Debug, Clone)]
pub(crate) struct Taken<'a> {
    pub(crate) query: &'a Query,
    pub(crate) instance: Option<&'a Name>,
    pub(crate) choice: Choice,
}

/// One method.
#[derive(Debug, Clone)]
pub(crate) struct Choices<'a> {
    pub(crate) method: &'a Name,
    pub(crate) is_ranked: bool,
    pub(crate) track: Track,
    /// Queries whose target is visible, in order.
    pub(crate) taken: Vec<Taken<'a>>,
}

impl Choices<'_> {
    /// Percent of the queries, in the order of [`Choice::ALL`].
    pub(crate) fn shares(&self) -> impl Iterator<Item = (Choice, f64)> {
        let all = self.taken.len().max(1) as f64;
        Choice::ALL.into_iter().map(move |choice| {
            let count = self.taken.iter().filter(|taken| taken.choice == choice).count();
            (choice, 100.0 * count as f64 / all)
        })
    }
}

/// What each detailed method took, in the order of the board.
pub(crate) fn choices<'a>(board: &'a Board, details: &'a Details) -> Vec<Choices<'a>> {
    let of_method = |((rank, row), detail): ((Option<usize>, &'a crate::BoardRow), &'a Detail)| Choices {
        method: &row.name,
        is_ranked: rank.is_some(),
        track: row.track,
        taken: taken(detail, details),
    };
    board.rows().zip(&details.methods).map(of_method).collect()
}

/// What was taken for what in one scene.
#[derive(Debug, Clone)]
pub(crate) struct Confusion<'a> {
    pub(crate) scene: &'a Name,
    /// Objects that are meant or were taken: those of a category beside each other, by name.
    pub(crate) objects: Vec<&'a Thing>,
    /// One entry an object: what was taken where it was meant.
    pub(crate) meant: Vec<Instead>,
}

/// Queries that mean an object, by what was taken.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Instead {
    /// One entry an object.
    pub(crate) objects: Vec<usize>,
    pub(crate) landmark: usize,
    /// Nothing, or nothing for sure.
    pub(crate) nothing: usize,
}

impl Instead {
    pub(crate) fn queries(&self) -> usize {
        self.objects.iter().sum::<usize>() + self.landmark + self.nothing
    }
}

/// What a method took for what, scene by scene; scenes without a visible target are left out. A query that means several
/// things counts for the one that was taken, else for the first.
pub(crate) fn confusions<'a>(choices: &Choices<'a>, details: &'a Details) -> Vec<Confusion<'a>> {
    let of_scene = |scene: &'a AskedScene| {
        let taken: Vec<&Taken> =
            choices.taken.iter().filter(|taken| taken.query.id.scene == scene.scene.name).collect();
        (!taken.is_empty()).then(|| confusion(scene, &taken))
    };
    details.asked.scenes.iter().filter_map(of_scene).collect()
}

fn confusion<'a>(scene: &'a AskedScene, taken: &[&Taken<'a>]) -> Confusion<'a> {
    let is_met = |name: &Name| {
        taken.iter().any(|one| one.query.referents.contains(name) || one.instance == Some(name))
    };
    let mut objects: Vec<&Thing> =
        scene.things.iter().filter(|thing| thing.role == Role::Object && is_met(&thing.name)).collect();
    objects.sort_by(|a, b| (&a.category, &a.name).cmp(&(&b.category, &b.name)));
    let place = |name: &Name| objects.iter().position(|thing| thing.name == *name);
    let mut meant = vec![Instead { objects: vec![0; objects.len()], ..Instead::default() }; objects.len()];
    for one in taken {
        let own = one.instance.filter(|name| one.query.referents.contains(name));
        let Some(row) = own.or(one.query.referents.first()).and_then(place) else { continue };
        let chosen = one.instance.filter(|_| one.choice != Choice::Tied);
        match chosen.map(place) {
            Some(Some(column)) => meant[row].objects[column] += 1,
            Some(None) => meant[row].landmark += 1,
            None => meant[row].nothing += 1,
        }
    }
    Confusion { scene: &scene.scene.name, objects, meant }
}

fn taken<'a>(detail: &'a Detail, details: &'a Details) -> Vec<Taken<'a>> {
    let queries =
        details.asked.scenes.iter().flat_map(|scene| scene.queries.iter().map(move |query| (scene, *query)));
    let pairs = queries.zip(detail.tallies.iter().zip(&detail.queries));
    let one = |((scene, query), (tally, found)): (
        (&AskedScene, &'a Query),
        (&l4d_score::metrics::QueryTally, &'a crate::detail::QueryDetail),
    )| {
        let selected = tally.ratios().select?;
        let instance = found.taken.as_ref();
        Some(Taken { query, instance, choice: choice(scene, query, instance, selected > 0.5) })
    };
    pairs.filter_map(one).collect()
}

fn choice(scene: &AskedScene, query: &Query, instance: Option<&Name>, is_selected: bool) -> Choice {
    let Some(instance) = instance else { return Choice::Nothing };
    if query.referents.contains(instance) {
        return if is_selected { Choice::Meant } else { Choice::Tied };
    }
    let of = |name: &Name| scene.things.iter().find(|thing| thing.name == *name);
    let is_alike =
        |category: &str| query.referents.iter().filter_map(&of).any(|referent| referent.category == category);
    match of(instance) {
        Some(thing) if thing.role == Role::Landmark => Choice::Landmark,
        Some(thing) if is_alike(&thing.category) => Choice::LookAlike,
        _ => Choice::OtherObject,
    }
}
