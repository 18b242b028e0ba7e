//! `spineline serve`: the browser app, on this machine by default.

mod archives;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use spineline_server::{ServeLimits, ServeOptions, Server, is_host};
use spineline_store::{Access, Name, Role, Signature, Store, wider_permissions};

use crate::analysis::study::{add_case, compare_case};
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::is_case;
use crate::run::interrupt;
use crate::run::messages::{say, say_origin_of_weights};
use crate::run::outputs::print;

use archives::ArchiveArgs;

/// What a user types.
pub const EXAMPLES: &str = "\
Examples:
  spineline serve                          the app on studies.spineline, for the user of this terminal
  spineline serve P07/case.json            a case: its films and readings, kept in P07/case.spineline
  spineline serve clinic.spineline --port 9000
  spineline serve clinic.spineline --accounts
  spineline serve clinic.spineline --bind 192.168.1.20 --host spine.clinic.example --https
  spineline serve --dicomweb clinic=https://pacs.clinic.example/dicom-web --dicomweb-login clinic=clinic.login

Without accounts, the printed address signs in one browser; a new one is printed after each use. Addresses other than this \
machine's own require accounts (`spineline account add NAME --role admin STORE`). Ctrl-C stops the server.

With --dicomweb, users who may make studies can also open films from that archive, found by Patient ID or Accession Number. The \
program asks no other address. Give the address of the DICOMweb service (QIDO-RS and WADO-RS), such as \
http://localhost:8042/dicom-web for Orthanc. Keep a login in a file that only you can read (chmod 600). The log of the store \
says who searched and who opened a film.";

/// Port, unless another program has it.
const PORT: u16 = 8765;

/// Start the browser app
#[derive(Debug, Clone, Args)]
pub struct ServeArgs {
    /// Store of studies, created if it does not exist; or a case: a store beside it keeps its study
    #[arg(default_value = "studies.spineline", value_name = "STORE|CASE")]
    store: PathBuf,

    /// Port; 0: a free one [default: 8765, or a free one if it is in use]
    #[arg(long)]
    port: Option<u16>,

    /// Address to listen on; other addresses than loopback require accounts, and their traffic is not encrypted
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    bind: IpAddr,

    /// Host name in the browser's address, beside the address itself and `localhost`; may be repeated
    #[arg(long = "host", value_name = "NAME", value_parser = host)]
    hosts: Vec<String>,

    /// Require accounts and passwords on this machine too
    #[arg(long)]
    accounts: bool,

    /// Behind a TLS proxy: cookies are sent over https only, and browsers must use https
    #[arg(long)]
    https: bool,

    #[command(flatten)]
    archives: ArchiveArgs,
}

fn host(text: &str) -> Result<String, String> {
    let expected = || "expected a host name as browsers send it, such as spine.clinic.example";
    if is_host(text) { Ok(text.to_owned()) } else { Err(expected().to_owned()) }
}

pub fn run(args: &ServeArgs) -> Result<Ending, Failure> {
    check_clock()?;
    let archives = args.archives.read()?;
    let case = is_case(&args.store).then_some(&args.store);
    let store = case.map_or_else(|| args.store.clone(), |case| case.with_extension("spineline"));
    let args = &ServeArgs { store, ..args.clone() };
    let store = case.map_or_else(|| open(args), |case| open_beside(args, case))?;
    let access =
        if args.accounts || !args.bind.is_loopback() { Access::Accounts } else { Access::Token };
    check(args, &store, access)?;
    if let Some(mode) = wider_permissions(&args.store) {
        let store = args.store.display();
        say(format!(
            "warning: other users of this machine have access to {store} (permissions {mode}), which holds films and names of readers; close it with: chmod 600 {store}"
        ));
    }
    if !spineline_server::has_app() {
        say(
            "warning: the browser app is not in this program: its address shows a page that says so; build the app with `cargo xtask web` (needs Node), then build the program again",
        );
    }
    say_origin_of_weights();
    let decoder = std::env::current_exe()
        .map_err(|error| Failure::internal(format!("this program cannot find itself: {error}")))?;
    let options = ServeOptions {
        decoder,
        decoder_arguments: vec!["decode-film".to_owned()],
        access,
        hosts: args.hosts.clone(),
        https: args.https,
        archives,
        limits: ServeLimits::default(),
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| Failure::internal(error.to_string()))?;
    let ending = runtime.block_on(serve(args, store, options));
    // Requests under way are not waited for: what is not committed is not stored.
    runtime.shutdown_background();
    ending
}

/// Opens the store beside a case, with the study of the case.
fn open_beside(args: &ServeArgs, case: &Path) -> Result<Store, Failure> {
    if !case.exists() {
        let help = "check the path; `spineline import` makes a case of films";
        return Err(Failure::input(case.display(), "no such case", help));
    }
    let is_new = !args.store.exists();
    let mut store = open(args)?;
    let studies = store.studies().map_err(|error| Failure::file(&args.store, &error))?;
    if studies.is_empty() {
        if let Err(failure) = add_study(args, &mut store, case) {
            // Removes a store whose only study cannot be made.
            let _ = is_new.then(|| store.discard());
            return Err(failure);
        }
    } else {
        for remark in compare_case(&store, &args.store, case)? {
            say(format!("warning: {remark}"));
        }
    }
    say(format!("{}: its study is kept in {}", case.display(), args.store.display()));
    Ok(store)
}

/// Makes the study of a case in a store without studies.
fn add_study(args: &ServeArgs, store: &mut Store, case: &Path) -> Result<(), Failure> {
    let fail = |error| Failure::file(&args.store, &error);
    print(add_case(store, fail, case, false, &signature(&args.store)?)?).map(|_| ())
}

fn signature(store: &Path) -> Result<Signature, Failure> {
    let name = Name::new("serve").map_err(|error| Failure::file(store, &error))?;
    Ok(Signature::now(name))
}

fn open(args: &ServeArgs) -> Result<Store, Failure> {
    let fail = |error| Failure::file(&args.store, &error);
    // An empty file becomes a store, like a missing one.
    if std::fs::metadata(&args.store).is_ok_and(|found| !found.is_file() || found.len() > 0) {
        let store = Store::open(&args.store).map_err(fail)?;
        if let Some(lost) = store.lost_head() {
            let name = args.store.display();
            say(format!(
                "warning: {name} went back: entry {} of its log was acknowledged and is missing, because an earlier copy is in its place or its log was lost; the next change writes this into the log (`spineline study verify {name}`)",
                lost.entries
            ));
        }
        return Ok(store);
    }
    Store::create(&args.store, &signature(&args.store)?).map_err(fail)
}

/// The library that serves cannot write the date of an answer before 1970 or after 9999.
fn check_clock() -> Result<(), Failure> {
    const END_S: u64 = 253_402_300_800;
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH);
    if since_1970.is_ok_and(|time| time.as_secs() < END_S) {
        return Ok(());
    }
    let what = "the time is before 1970 or after 9999";
    Err(Failure::input("the clock of this computer", what, "set the clock, and start again"))
}

/// Refuses settings that give access to the wrong people or to no one.
fn check(args: &ServeArgs, store: &Store, access: Access) -> Result<(), Failure> {
    let name = args.store.display();
    if access == Access::Accounts {
        let accounts = store.accounts().map_err(|error| Failure::file(&args.store, &error))?;
        if !accounts.iter().any(|account| account.enabled && account.role == Role::Admin) {
            let why = if args.accounts { "--accounts" } else { "an address other than loopback" };
            let what = format!("{why} requires an admin account, and the store has none");
            let help = format!("run: spineline account add NAME --role admin {name}");
            return Err(Failure::input(name, what, help));
        }
    }
    if args.bind.is_unspecified() && args.hosts.is_empty() {
        return Err(Failure::usage(format!(
            "--bind {} listens on every address of this machine; give the host name that browsers use: --host NAME",
            args.bind
        )));
    }
    if !args.bind.is_loopback() && !args.https {
        say(format!(
            "warning: films, names and passwords are not encrypted between {} and the browsers: others can read and change them; use a TLS proxy, and start with --https",
            args.bind
        ));
    }
    Ok(())
}

async fn serve(args: &ServeArgs, store: Store, options: ServeOptions) -> Result<Ending, Failure> {
    let (access, https) = (options.access, options.https);
    let address = SocketAddr::new(args.bind, args.port.unwrap_or(PORT));
    let fail =
        |error: std::io::Error| Failure::input(address, error, "try another --port, or --port 0");
    let listener = match tokio::net::TcpListener::bind(address).await {
        Err(error) if args.port.is_none() && error.kind() == std::io::ErrorKind::AddrInUse => {
            say(format!("note: port {PORT} is in use; a free port is used instead"));
            tokio::net::TcpListener::bind(SocketAddr::new(args.bind, 0)).await
        }
        other => other,
    };
    // Its ordinary end.
    let _stopped_by_signal = interrupt::defer();
    let server = Server::on(listener.map_err(fail)?, store, options).map_err(fail)?;
    let base = base(args, server.address(), https);
    if access == Access::Token {
        let mut tokens = server.tokens();
        let token = tokens.borrow_and_update().clone();
        print(format!("{base}#token={token}"))?;
        print("Open this address in a browser; it works once. Press Ctrl-C to stop.")?;
        tokio::spawn(async move {
            while tokens.changed().await.is_ok() {
                let token = tokens.borrow_and_update().clone();
                // A closed terminal needs no further address.
                let _ = print(format!("Address for another browser: {base}#token={token}"));
            }
        });
    } else {
        print(base)?;
        print("Open this address in a browser and sign in with an account. Press Ctrl-C to stop.")?;
    }
    server.run(interrupt::requested()).await;
    Ok(Ending::Done)
}

/// The address without a token.
fn base(args: &ServeArgs, address: SocketAddr, https: bool) -> String {
    match args.hosts.first() {
        Some(host) if https => format!("https://{host}/"),
        Some(host) if args.bind.is_unspecified() && !host.contains(':') => {
            format!("http://{host}:{}/", address.port())
        }
        _ => format!("http://{address}/"),
    }
}
