//! `l4d endpoint`: what a model server supports, and how its model writes boxes.

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::workspace::SharedWork;
use l4d_endpoint::calibration::{Calibration, Sample, calibrate};
use l4d_endpoint::probe::{State, probe};
use l4d_endpoint::{BoxPx, Calibrations, Client, Image};
use l4d_frames::targets::Targets;
use serde_json::json;

use crate::cli::models::{EndpointCalibrateArgs, EndpointCheckArgs, EndpointCommand};
use crate::models::about;
use crate::out::{ExitStatus, Printer};

const PROBES: u64 = 7;
/// Side of the picture whose colour is asked for, pixels: small for a server, not too small for any model.
const PLAIN_SIDE: u32 = 224;

pub(crate) fn run(command: &EndpointCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        EndpointCommand::Check(args) => check(args, out),
        EndpointCommand::Calibrate(args) => run_calibrate(args, out),
    }
}

fn check(args: &EndpointCheckArgs, out: &Printer) -> Result<ExitStatus> {
    let mut endpoint = args.endpoint.resolve()?;
    // A check reports a server that is down at once.
    endpoint.retry.tries = 1;
    let client = Client::open(endpoint, &args.endpoint.link)?;
    let (bytes, colour) = Targets::plain(PLAIN_SIDE, PLAIN_SIDE);
    let image = Image::new(bytes)?;
    out.start("asking", PROBES);
    let lines = probe(&client, (&image, colour), |name| {
        out.item(&name);
        out.advance(1);
    });
    out.finish();
    let endpoint = client.endpoint();
    if args.json {
        out.json(&json!({ "endpoint": about(endpoint), "check": lines }))?;
    } else {
        out.note(format!("{} at {} ({})", endpoint.model, endpoint.base_url, endpoint.note()));
        for line in &lines {
            let mark = match line.state {
                State::Ok => "ok",
                State::Lacking => "--",
                State::Unclear => "?",
                State::Failed => "FAILED",
            };
            let hint = if line.hint.is_empty() { String::new() } else { format!(" -> {}", line.hint) };
            out.data(format!("{mark:<8}{:<10}{}{hint}", line.name, line.found))?;
        }
    }
    let failed = lines.iter().any(|line| line.state == State::Failed);
    Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success })
}

fn run_calibrate(args: &EndpointCalibrateArgs, out: &Printer) -> Result<ExitStatus> {
    let client = Client::open(args.endpoint.resolve()?, &args.endpoint.link)?;
    let path = SharedWork::new(&args.work).endpoints();
    let mut calibrations = Calibrations::read(&path)?;
    let [width, height] = args.size.0.map(|side| side.max(Targets::MIN_SIDE));
    let size = (width, height);
    let samples: Result<Vec<Sample>> = (0..args.pictures).map(|number| sample(size, number)).collect();
    out.note(format!("asking {} about {} pictures", client.endpoint().model, args.pictures));
    let found = calibrate(&client, &samples?, args.answer_tokens)?;
    let winner = found.winner();
    calibrations.note(client.endpoint(), winner, size);
    calibrations.write(&path)?;
    if args.json {
        out.json(&document(&client, &found, size))?;
    } else {
        for score in &found.scores {
            let percent = 100.0 * score.mean_iou;
            out.data(format!("{:<24}{:<10}{percent:>6.1} % overlap", score.convention, score.key))?;
        }
        tell(&found, out);
    }
    if winner.is_none() {
        return Ok(ExitStatus::Findings);
    }
    out.note(format!("remembered in {}", path.display()));
    Ok(ExitStatus::Success)
}

fn sample(size: (u32, u32), number: u32) -> Result<Sample> {
    let targets = Targets::arrange(size.0, size.1, number);
    let squares = targets.squares().iter().map(|square| {
        let [x, y, side] = [square.x, square.y, square.side_px].map(f64::from);
        (square.colour.to_owned(), BoxPx { x0: x, y0: y, x1: x + side, y1: y + side })
    });
    Ok(Sample { image: Image::new(targets.png())?, squares: squares.collect() })
}

fn document(client: &Client, found: &Calibration, (width, height): (u32, u32)) -> serde_json::Value {
    json!({
        "endpoint": about(client.endpoint()),
        "size": [width, height],
        "squares": found.squares,
        "scores": found.scores,
        "winner": found.winner(),
        "failures": found.failures,
    })
}

fn tell(found: &Calibration, out: &Printer) {
    for failure in &found.failures {
        out.warn(failure);
    }
    match (found.fit(), found.rival()) {
        (Some(fit), None) => {
            out.note(format!("{} fits; ask for boxes under the field name `{}`", fit.convention, fit.key));
        }
        (Some(fit), Some(rival)) => {
            out.warn(format!("{} and {} fit about as well", fit.convention, rival.convention));
            out.note(
                "hint: use a larger --size or more --pictures, or set `coordinates` in the endpoint file",
            );
        }
        (None, _) => {
            out.warn(
                "no convention fits: the model does not find the squares, or writes boxes in another way",
            );
            out.note("hint: check that it can see (`l4d endpoint check`), give it more --answer-tokens, or use a larger model");
        }
    }
}
