// A proxy before the server that holds answers back or cuts them short, as a bad line does.
import http from 'node:http';

/**
 * Starts it before the server on `port`. `fault(path)`: what to do with the answer: 'cut' (half of its body, then the end),
 * a number of milliseconds to hold it back, or nothing.
 */
export async function startFlakyProxy(port, fault) {
  const server = http.createServer((request, response) => {
    const { url: path, method, headers } = request;
    const onward = http.request({ host: '127.0.0.1', port, path, method, headers }, (answer) => {
      const parts = [];
      answer.on('data', (part) => parts.push(part));
      answer.on('end', async () => {
        const body = Buffer.concat(parts);
        const what = fault(path);
        if (typeof what === 'number') await new Promise((resolve) => setTimeout(resolve, what));
        response.writeHead(answer.statusCode, answer.headers);
        if (what !== 'cut') return response.end(body);
        response.write(body.subarray(0, body.length / 2), () => response.destroy());
      });
    });
    onward.on('error', () => response.destroy());
    request.pipe(onward);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    stop: () => new Promise((resolve) => {
      server.close(resolve);
      server.closeAllConnections();
    }),
  };
}
