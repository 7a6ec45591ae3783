//! Completions for shells and manual pages, made of the same command line that the program reads.

use clap::{Args, Command};
use clap_complete::Shell;
use plotter_examples::shared::{at, print, run};
use std::path::PathBuf;
use std::process::ExitCode;

/// Prints completions for a shell.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  plotter completions bash > ~/.local/share/bash-completion/completions/plotter\n  \
                  plotter completions zsh > ~/.zfunc/_plotter"
)]
pub(crate) struct Completions {
    /// The shell that is to complete the program's words
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self, mut command: Command) -> ExitCode {
        run("completions", || {
            let mut script = Vec::new();
            clap_complete::generate(self.shell, &mut command, "plotter", &mut script);
            print(&String::from_utf8_lossy(&script))
        })
    }
}

/// Writes the manual: the program's page, or with a folder one page for it and for each subcommand.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  plotter man | man -l -\n  plotter man ~/.local/share/man/man1")]
pub(crate) struct Man {
    /// Folder for plotter.1, plotter-trace.1 and so on [default: the program's page on the standard output]
    folder: Option<PathBuf>,
}

impl Man {
    pub(crate) fn run(&self, command: Command) -> ExitCode {
        run("man", || match &self.folder {
            None => {
                let mut page = Vec::new();
                clap_mangen::Man::new(command).render(&mut page).map_err(|error| error.to_string())?;
                print(&String::from_utf8_lossy(&page))
            }
            Some(folder) => {
                std::fs::create_dir_all(folder)
                    .map_err(|error| at(folder, &format!("this folder cannot be made: {error}")))?;
                clap_mangen::generate_to(command, folder)
                    .map_err(|error| at(folder, &format!("cannot be written: {error}")))
            }
        })
    }
}
