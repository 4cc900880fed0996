// The client of the language server: starts `lss lsp` and lets the editor speak to it.

"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

/** @type {LanguageClient | undefined} */
let client;

function settings() {
  const own = vscode.workspace.getConfiguration("lss");
  return { path: own.get("server.path") || "lss", seconds: own.get("solve.seconds") ?? 10 };
}

async function start() {
  const { path, seconds } = settings();
  const program = { command: path, args: ["lsp"] };
  client = new LanguageClient(
    "lss",
    "lss",
    { run: program, debug: program },
    {
      documentSelector: [{ language: "lss" }],
      initializationOptions: { solveSeconds: seconds },
    },
  );
  try {
    await client.start();
  } catch (why) {
    const choice = "Open settings";
    const message = `Could not start the language server \`${path} lsp\`: ${why}`;
    if ((await vscode.window.showErrorMessage(message, choice)) === choice) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "lss.server.path");
    }
  }
}

async function stop() {
  const running = client;
  client = undefined;
  if (running?.isRunning()) {
    await running.stop();
  }
}

async function restart() {
  await stop();
  await start();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("lss.restart", restart),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("lss")) {
        return restart();
      }
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
