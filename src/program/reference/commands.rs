//! Every command, from what clap knows of it.

use clap::builder::StyledStr;
use clap::{Arg, Command, CommandFactory};

use crate::program::cli::Cli;
use crate::program::reference::markdown::{code, line, table};

const HEAD: &str = "\
# Command-line reference

<!-- Made by `grainfall reference --out book/src` from the program: change the help
texts there, not this page. -->

Every command with all its options, as `grainfall COMMAND --help` tells them. What
the commands are for is told in [Getting started](getting-started.md) and in the
[tutorials](tutorials.md); what a scenario may say, in the
[scenario reference](reference-scenario.md).
";

pub(super) fn page() -> String {
    let mut root = Cli::command();
    root.build();
    let mut page = HEAD.to_owned();
    let rows: Vec<Vec<String>> = root
        .get_subcommands()
        .filter(|command| command.get_name() != "help")
        .map(|command| {
            let name = format!("grainfall {}", command.get_name());
            let link = format!("[`{name}`](#{})", name.replace(' ', "-"));
            vec![link, about(command)]
        })
        .collect();
    page.push_str(&format!("\n{}", table(&["command", "what it does"], &rows)));
    page.push_str(&after_help(&root));
    for command in root.get_subcommands_mut() {
        section(command, "grainfall", 2, &mut page);
    }
    page
}

/// A command and those below it.
fn section(command: &mut Command, above: &str, level: usize, page: &mut String) {
    if command.get_name() == "help" {
        return;
    }
    let name = format!("{above} {}", command.get_name());
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage:").trim();
    page.push_str(&format!("\n{} `{name}`\n\n", "#".repeat(level)));
    page.push_str(&format!("{}.\n\n```text\n{usage}\n```\n", about(command)));
    let rows: Vec<Vec<String>> = command
        .get_arguments()
        .filter(|argument| !matches!(argument.get_id().as_str(), "help" | "version"))
        .map(row)
        .collect();
    if !rows.is_empty() {
        let head = ["argument", "what it is", "default", "allowed"];
        page.push_str(&format!("\n{}", table(&head, &rows)));
    }
    page.push_str(&after_help(command));
    for inner in command.get_subcommands_mut() {
        section(inner, &name, level + 1, page);
    }
}

/// What stands below the options: examples, as they are.
fn after_help(command: &Command) -> String {
    let text = command.get_after_help().map(StyledStr::to_string);
    text.map_or(String::new(), |text| format!("\n```text\n{text}\n```\n"))
}

fn about(command: &Command) -> String {
    let text = command.get_about().map(StyledStr::to_string);
    line(text.unwrap_or_default().trim_end_matches('.'))
}

/// An argument: how it is typed, what it is, its default and its words.
fn row(argument: &Arg) -> Vec<String> {
    let help = argument.get_help().map(StyledStr::to_string);
    let (what, told) = split_default(&help.unwrap_or_default());
    let takes = argument.get_action().takes_values();
    let mut defaults: Vec<String> = argument
        .get_default_values()
        .iter()
        .filter(|_| takes)
        .map(|value| code(&value.to_string_lossy()))
        .collect();
    if argument.is_required_set() {
        defaults.push("required".to_owned());
    }
    defaults.extend(told.map(|told| line(&told)));
    let words: Vec<String> = argument
        .get_possible_values()
        .iter()
        .filter(|_| takes)
        .map(|value| {
            let what = value.get_help().map(|what| line(&what.to_string()));
            match what {
                Some(what) => format!("{}: {what}", code(value.get_name())),
                None => code(value.get_name()),
            }
        })
        .collect();
    let separator = if words.iter().any(|word| word.contains(':')) {
        "; "
    } else {
        ", "
    };
    vec![
        typed(argument),
        line(&what),
        defaults.join(", "),
        words.join(separator),
    ]
}

/// How it is typed.
fn typed(argument: &Arg) -> String {
    let names: Vec<String> = argument
        .get_value_names()
        .unwrap_or_default()
        .iter()
        .map(ToString::to_string)
        .collect();
    let Some(long) = argument.get_long() else {
        return code(&names.join(" "));
    };
    let value = if argument.get_action().takes_values() {
        format!(" {}", names.join(" "))
    } else {
        String::new()
    };
    let long = code(&format!("--{long}{value}"));
    match argument.get_short() {
        Some(short) => format!("{long}, {}", code(&format!("-{short}"))),
        None => long,
    }
}

/// Takes `[default: …]` from the end of a help text.
fn split_default(help: &str) -> (String, Option<String>) {
    let help = help.trim().trim_end_matches('.');
    match help.split_once("[default:") {
        Some((what, told)) => {
            let told = told.trim().trim_end_matches(']').to_owned();
            (what.trim().to_owned(), Some(told))
        }
        None => (help.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_and_every_option_is_told() {
        let page = page();
        let mut commands = vec![Cli::command()];
        let mut options = 0;
        while let Some(command) = commands.pop() {
            for argument in command.get_arguments() {
                if let Some(long) = argument.get_long() {
                    assert!(page.contains(&format!("`--{long}")), "--{long}");
                    options += 1;
                }
            }
            for inner in command.get_subcommands() {
                assert!(page.contains(inner.get_name()), "{}", inner.get_name());
                commands.push(inner.clone());
            }
        }
        assert!(options > 60, "{options}");
    }
}
