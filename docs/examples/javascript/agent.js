// An agent in JavaScript: walks straight to the target, and jumps when it gets nowhere.
//
// Its folder also holds match.proto and the packages of package.json (`npm install`), because there is no network
// in a match.

const path = require("node:path");
const grpc = require("@grpc/grpc-js");
const loader = require("@grpc/proto-loader");

const PROTOCOL_VERSION = 1;
const FULL_SPEED = 10; // m/s
const STUCK = 0.5; // m/s; slower than this is not getting on

const definition = loader.loadSync(path.join(__dirname, "match.proto"), { keepCase: true, defaults: true });
const { Match } = grpc.loadPackageDefinition(definition).wildscav.match.v1;

/** Returns the compass direction from one place to another, degrees: 0 is north (+z), 90 is east (+x). */
function direction(from, to) {
  return (Math.atan2(to.x - from.x, to.z - from.z) * 180) / Math.PI;
}

/** Returns the action that answers an observation. */
function act(observation) {
  const { position, velocity, target } = observation;
  const speed = Math.hypot(velocity.x, velocity.z);
  return {
    step: observation.step,
    walk_direction: target ? direction(position, target) : 0,
    walk_speed: FULL_SPEED,
    jump: observation.step > 0 && speed < STUCK,
  };
}

/** Plays one match, and calls `done` with the exit code of the process. */
function play(address, token, done) {
  const client = new Match(address, grpc.credentials.createInsecure(), { "grpc.enable_http_proxy": 0 });
  const stream = client.Play();
  stream.on("data", (message) => {
    if (message.match_info) {
      stream.write({ ready: {} }); // all that takes long belongs before this
    } else if (message.observation) {
      stream.write({ action: act(message.observation) });
    } else if (message.match_over) {
      stream.end();
    }
  });
  stream.on("error", (error) => {
    console.error(`the stream ended: ${error.message}`);
    done(1);
  });
  stream.on("end", () => {
    client.close();
    done(0);
  });
  const join = { token, protocol_version: PROTOCOL_VERSION, sdk_name: "homing-js", sdk_version: "1.0.0" };
  stream.write({ join: { ...join, gets_ready: true } });
}

play(process.env.WILDSCAV_ADDRESS, process.env.WILDSCAV_TOKEN, (code) => process.exit(code));
