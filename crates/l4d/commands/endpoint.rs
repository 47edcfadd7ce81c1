//! `l4d endpoint`: what a model server supports.

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_endpoint::probe::{State, probe};
use l4d_endpoint::{Client, Image};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use serde_json::json;

use crate::cli::models::{EndpointCheckArgs, EndpointCommand};
use crate::models::about;
use crate::out::{ExitStatus, Printer};

const PROBES: u64 = 7;
/// Side of the picture whose colour is asked for, pixels: small for a server, not too small for any model.
const PLAIN_SIDE: u32 = 224;
/// Red, to a model as to a person.
const PLAIN_COLOUR: Rgb<u8> = Rgb([220, 30, 30]);

pub(crate) fn run(command: &EndpointCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        EndpointCommand::Check(args) => check(args, out),
    }
}

fn check(args: &EndpointCheckArgs, out: &Printer) -> Result<ExitStatus> {
    let mut endpoint = args.endpoint.resolve()?;
    // A check reports a server that is down at once.
    endpoint.retry.tries = 1;
    let client = Client::open(endpoint, &args.endpoint.link)?;
    let picture = RgbImage::from_pixel(PLAIN_SIDE, PLAIN_SIDE, PLAIN_COLOUR);
    let image = Image::new(encode_colour(&picture))?;
    out.start("asking", PROBES);
    let lines = probe(&client, (&image, "red"), |name| {
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
