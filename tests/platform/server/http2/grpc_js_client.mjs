// Calls of @grpc/grpc-js to the server of peers.py. Prints what they ended with, as JSON.
import grpc from "@grpc/grpc-js";

const [address, echo, hang, large, check] = process.argv.slice(2);
const client = new grpc.Client(address, grpc.credentials.createInsecure(), {
  "grpc.max_receive_message_length": -1,
});
const same = (bytes) => bytes;

function unary(method, message, options = {}) {
  return new Promise((done) => {
    client.makeUnaryRequest(method, same, same, message, options, (error, answer) => {
      done(error ? error.code : answer.length);
    });
  });
}

function stream(messages, cancel = false) {
  return new Promise((done) => {
    const call = client.makeBidiStreamRequest(echo, same, same);
    const got = [];
    call.on("data", (answer) => {
      got.push(answer.length);
      if (cancel) call.cancel();
      else if (got.length < messages.length) call.write(messages[got.length]);
      else call.end();
    });
    call.on("error", () => {});
    call.on("status", (status) => done([status.code, ...got]));
    call.write(messages[0]);
  });
}

const results = {
  check: await unary(check, Buffer.alloc(0)),
  large: await unary(large, Buffer.from("x")),
  deadline: await unary(hang, Buffer.alloc(0), { deadline: Date.now() + 100 }),
  nothing: await unary("/no/method", Buffer.alloc(0)),
  stream: await stream([Buffer.alloc(0), Buffer.alloc(1), Buffer.alloc(200_000)]),
  cancelled: await stream([Buffer.alloc(3), Buffer.alloc(4)], true),
  many: (await Promise.all(Array.from({ length: 300 }, () => unary(large, Buffer.alloc(9))))).filter(
    (length) => length !== 300_000,
  ).length,
};
client.close();
console.log(JSON.stringify(results));
