//! Consensus as text for people: who goes on and why, who votes for whom, and every frame.

use std::collections::BTreeSet;
use std::iter::once;

use super::record::{Consensus, Decision, FrameVerdict, PairVerdict, ViewRecord, ViewVerdict};
use super::settings::GroupRule;

impl Consensus {
    /// Everything below, one after the other.
    pub(crate) fn explain(&self) -> String {
        [self.summary(), self.vote_table(), self.frame_table()].join("\n")
    }

    /// What goes on and why: a line for each view, and the groups.
    pub(crate) fn summary(&self) -> String {
        let preset = self.preset.map_or("settings of your own", |preset| preset.word());
        let mut text = format!(
            "consensus ({preset}): {} of {} views go on: {}\n{}\n\n",
            self.evidence.len(),
            self.views.len(),
            self.decision.sentence(),
            self.rules(),
        );
        let heading = ["view", "outcome", "frames", "votes", "score", "group", "goes on", "why"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        rows.extend(self.views.iter().enumerate().map(|(place, view)| self.view_row(place, view)));
        text.push_str(&table(&rows));
        for (place, group) in self.groups.iter().enumerate() {
            let names: Vec<String> = group.views.iter().map(|&view| self.name(view)).collect();
            let against: Vec<String> = group.against.iter().map(|&other| group_letter(other)).collect();
            let conflict = match against.is_empty() {
                true => String::new(),
                false => format!("; contradicts {}", against.join(", ")),
            };
            let letter = group_letter(place);
            text.push_str(&format!("group {letter}, {} views: {}{conflict}\n", names.len(), names.join(" ")));
        }
        text
    }

    /// Who votes for whom: a row for each proposal, a column for each judge.
    fn vote_table(&self) -> String {
        let mut rows = vec![self.heading("votes for")];
        rows.extend((0..self.views.len()).map(|of| {
            let cell = |judge: usize| match self.pair(of, judge) {
                None => "-".to_owned(),
                Some(pair) => {
                    let word = match pair.verdict {
                        PairVerdict::Vote => "vote",
                        PairVerdict::NoVote => "no",
                        PairVerdict::CannotSee => "blind",
                    };
                    format!("{word} {}/{}", pair.agreeing, pair.counted)
                }
            };
            once(self.name(of)).chain((0..self.views.len()).map(cell)).collect()
        }));
        format!("{}each cell: the judge's verdict, frames that agree / that count\n", table(&rows))
    }

    /// Every frame: a row for each, a column for each view.
    fn frame_table(&self) -> String {
        let frames: BTreeSet<u32> =
            self.views.iter().flat_map(|view| &view.frames).map(|&(frame, _)| frame).collect();
        let mut rows = vec![self.heading("frame")];
        rows.extend(frames.into_iter().map(|frame| {
            let cells = (0..self.views.len()).map(|view| self.frame_cell(view, frame));
            once(frame.to_string()).chain(cells).collect()
        }));
        format!(
            "{}each cell: pixels marked, judges that agree + disagree, frames without a word (.) not counted\n",
            table(&rows)
        )
    }

    fn heading(&self, first: &str) -> Vec<String> {
        once(first.to_owned()).chain((0..self.views.len()).map(|view| self.name(view))).collect()
    }

    /// How many judges agree and disagree with a view's proposal at a frame.
    fn tally(&self, of: usize, frame: u32) -> [usize; 2] {
        let about = self.pairs.iter().filter(|pair| pair.of == of);
        let records = about.flat_map(|pair| &pair.frames).filter(|record| record.frame == frame);
        let verdicts: Vec<FrameVerdict> = records.map(|record| record.verdict).collect();
        [FrameVerdict::Agrees, FrameVerdict::Disagrees]
            .map(|wanted| verdicts.iter().filter(|&&verdict| verdict == wanted).count())
    }

    fn rules(&self) -> String {
        let settings = &self.settings;
        if !settings.is_on {
            return "views do not vote".to_owned();
        }
        let groups = match settings.group_rule {
            GroupRule::Shown => "groups of views are shown and decide nothing",
            GroupRule::LargestWins => "of groups in conflict the largest wins",
        };
        format!(
            "a frame agrees above IoU {}, a view votes above {} of its frames, a view is reliable above {} of its \
             judges and with {} or more votes; {groups}",
            settings.delta, settings.epsilon, settings.tau, settings.min_votes,
        )
    }

    fn view_row(&self, place: usize, view: &ViewRecord) -> Vec<String> {
        let goes_on = if self.evidence.contains(&place) { "yes" } else { "no" };
        vec![
            view.view.to_string(),
            view.outcome.clone(),
            view.marked_frames.to_string(),
            format!("{}/{}", view.votes, view.judges),
            view.score().map_or("-".to_owned(), |score| format!("{score:.2}")),
            self.group_of(place).map_or("-".to_owned(), group_letter),
            goes_on.to_owned(),
            view.standing.sentence().to_owned(),
        ]
    }

    fn frame_cell(&self, view: usize, frame: u32) -> String {
        let pixels = match self.views[view].frames.iter().find(|marked| marked.0 == frame) {
            None => return "-".to_owned(),
            Some((_, 0)) => String::new(),
            Some((_, pixels)) => format!("{pixels} "),
        };
        match self.tally(view, frame) {
            [0, 0] => format!("{pixels}."),
            [agree, disagree] if pixels.is_empty() => format!(". +{agree} -{disagree}"),
            [agree, disagree] => format!("{pixels}+{agree} -{disagree}"),
        }
    }

    fn name(&self, view: usize) -> String {
        self.views[view].view.to_string()
    }
}

impl Decision {
    fn sentence(self) -> &'static str {
        match self {
            Self::Off => "consensus is off, all that found something",
            Self::Bypassed => "one view alone answered, and no other can vote on it",
            Self::Reliable => "enough others vote for them",
            Self::BestView => "no view is reliable, this is the best that has a vote",
            Self::NoneReliable => "no view is reliable, so there is no answer",
            Self::NoneReliableAll => "no view is reliable, so all that found something",
            Self::Tied => "groups of views of equal size contradict each other, so there is no answer",
            Self::TiedAll => {
                "groups of views of equal size contradict each other, so all that found something"
            }
            Self::Absent => "all views that answered say that it is not there",
            Self::NoAnswer => "no view answered",
        }
    }
}

impl ViewVerdict {
    fn sentence(self) -> &'static str {
        match self {
            Self::Reliable => "reliable",
            Self::Best => "not reliable, but the best",
            Self::Absent => "says that it is not there",
            Self::NoAnswer => "did not answer",
            Self::NoJudge => "no other view could see it",
            Self::FewVotes => "too few votes",
            Self::LowScore => "too small a share of votes",
            Self::Outvoted => "a larger group contradicts it",
            Self::Tied => "a group of the same size contradicts it",
        }
    }
}

/// A, B, ... Z, then by number.
fn group_letter(group: usize) -> String {
    match u8::try_from(group) {
        Ok(place @ 0..26) => char::from(b'A' + place).to_string(),
        _ => (group + 1).to_string(),
    }
}

/// Rows with columns as wide as their widest cell; the first row is the heading.
fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells: Vec<String> =
            std::iter::zip(row, &widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}
