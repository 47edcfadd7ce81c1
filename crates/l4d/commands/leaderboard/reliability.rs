//! How sure PanopticQuery was of its answers: what consensus left in `work/`, beside whether the answer was right.

use anyhow::Result;
use l4d_board::{Answered, Board, Details, Reliability};
use l4d_data::json;
use l4d_data::layout::WorkDir;
use l4d_score::Exam;
use l4d_solve::consensus::Consensus;

use crate::cli::judging::LeaderboardArgs;

/// The methods whose consensus stands there, in the order of the board.
pub(super) fn of_methods(args: &LeaderboardArgs, exam: &Exam, details: &Details) -> Result<Vec<Reliability>> {
    let mut methods: Vec<Reliability> = Vec::new();
    for choice in details.choices() {
        let scene = WorkDir::new(&args.work, exam.profile, &choice.query.scene);
        let path = scene.answer(choice.method, &choice.query.number).consensus();
        if !path.is_file() {
            continue;
        }
        if methods.last().is_none_or(|last| last.method != choice.method.as_str()) {
            let method = choice.method.to_string();
            methods.push(Reliability { method, answers: Vec::new(), uncertain: 0 });
        }
        let Some(method) = methods.last_mut() else { continue };
        match certainty(&json::read(&path)?) {
            Some(certainty) => {
                let scene = choice.query.scene.clone();
                method.answers.push(Answered { scene, certainty, is_right: choice.is_right });
            }
            None => method.uncertain += 1,
        }
    }
    methods.retain(|method| !method.answers.is_empty());
    Ok(methods)
}

/// Mean over the believed views of the share of views that vote for them; none where nothing was voted on.
fn certainty(consensus: &Consensus) -> Option<f64> {
    let believed = consensus.evidence.iter().filter_map(|&index| consensus.views.get(index));
    let shares: Vec<f64> = believed
        .filter(|view| view.judges > 0)
        .map(|view| f64::from(view.votes) / f64::from(view.judges))
        .collect();
    (!shares.is_empty()).then(|| (shares.iter().sum::<f64>() / shares.len() as f64).min(1.0))
}

/// What the figure shows.
pub(super) fn about(board: &Board) -> Vec<String> {
    vec![
        format!("{}.", board.heading.line()),
        "Of the views that could vote, the share that agrees with the believed ones, against the share of answers that \
         overlap what is meant most (select)."
            .to_owned(),
    ]
}
