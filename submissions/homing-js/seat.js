// The protocol: plays one seat of one match, as match.proto describes it.

import { fileURLToPath } from "node:url";
import grpc from "@grpc/grpc-js";
import loader from "@grpc/proto-loader";
import { decodeTensors } from "./tensors.js";

const PROTOCOL_VERSION = 1;
const CHANNEL = {
  "grpc.enable_http_proxy": 0, // an agent talks to the match server alone
  "grpc.max_receive_message_length": -1, // the readings of cameras can be large
};

// Names stay as in the proto. Numbers that are not set are 0; messages and optional fields that are not set, null. The
// only 64-bit number that can be too large for a JavaScript number is MatchInfo.seed, so those are decimal strings.
const definition = loader.loadSync(fileURLToPath(new URL("match.proto", import.meta.url)), {
  keepCase: true,
  defaults: true,
  oneofs: true,
  longs: String,
});
const { Match } = grpc.loadPackageDefinition(definition).wildscav.match.v1;

/**
 * Plays the seat that the environment names, and ends the process: with exit code 0 after the match's end, else 1.
 *
 * @param agent has `reset(matchInfo)`, and `act(observation)`, which returns the fields of an Action but for its step.
 *   `observation.sensors` has the readings by name, each as {shape, numbers}.
 * @param {string} name of the agent, for the host's log.
 * @param {string} version of the agent, for the host's log.
 */
export function playSeat(agent, name, version) {
  const { WILDSCAV_ADDRESS: address, WILDSCAV_TOKEN: token } = process.env;
  if (!address || !token) {
    leave("WILDSCAV_ADDRESS and WILDSCAV_TOKEN are not set: start the agent with `wildscav play`");
  }
  const client = new Match(address, grpc.credentials.createInsecure(), CHANNEL);
  const stream = client.Play();
  let over = false;
  stream.on("data", (message) => {
    switch (message.content) {
      case "match_info":
        getReady(agent, message.match_info);
        stream.write({ ready: {} });
        break;
      case "observation":
        stream.write({ action: answer(agent, message.observation) });
        break;
      case "match_over":
        over = true;
        stream.end();
        break;
    }
  });
  stream.on("error", (error) => leave(`the match ended early: ${error.details || error.message}`));
  stream.on("end", () => (over ? process.exit(0) : leave("the match ended early, without a MatchOver")));
  stream.write({
    join: { token, protocol_version: PROTOCOL_VERSION, sdk_name: name, sdk_version: version, gets_ready: true },
  });
}

function getReady(agent, match) {
  if (match.protocol_version !== PROTOCOL_VERSION) {
    leave(`the server speaks version ${match.protocol_version} of the protocol, this agent ${PROTOCOL_VERSION}`);
  }
  agent.reset(match);
}

/** Returns the Action for an observation, for the step that the observation asks about. */
function answer(agent, observation) {
  observation.sensors = decodeTensors(observation.tensors);
  return { ...agent.act(observation), step: observation.step };
}

function leave(reason) {
  console.error(reason);
  process.exit(1);
}
