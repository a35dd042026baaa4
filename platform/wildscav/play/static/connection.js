// The WebSocket to the server: messages as JSON both ways, and pictures from it.

const DECODER = new TextDecoder();

export class Connection {
  // onMessage gets each message; onPicture gets what is shown beside a picture, and the picture as a Blob.
  constructor({ onMessage, onPicture, onClose }) {
    const address = new URL(`${location.pathname}/socket`, location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onclose = (event) => onClose(event.code, event.reason);
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") return onMessage(JSON.parse(data));
      const length = new DataView(data).getUint32(0, true);
      const head = JSON.parse(DECODER.decode(new Uint8Array(data, 4, length)));
      return onPicture(head, new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" }));
    };
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
