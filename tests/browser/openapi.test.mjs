// The OpenAPI document against the real server, in both directions: the document is valid, names every route, and every
// route, parameter and limit in it answers as it says:
//   node tests/browser/openapi.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER
import assert from 'node:assert/strict';
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parseArgs } from 'node:util';

import { Validator } from '@seriousme/openapi-schema-validator';
import Ajv2020 from 'ajv/dist/2020.js';
import gltf from 'gltf-validator';

import { ask, sleep } from '../support/http.mjs';
import { makeRoot, startServer } from '../support/server.mjs';
import { around, probesOf } from './probes.mjs';

const { values: paths } = parseArgs({
  options: { chamferd: { type: 'string' }, chamferprep: { type: 'string' }, data: { type: 'string' } },
});
const KEY = '0123456789abcdef';

let root;
let jobs;
let server;
let doc;
let info;
let scene;
let ajv;

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data);
  // A scene that can never be ready: its mesh is not the one that its sidecar was made for.
  copyFileSync(join(root.root, 'solids/cube.obj'), join(root.root, 'stale.obj'));
  copyFileSync(join(root.root, 'solids/octahedron.obj.chamfer'), join(root.root, 'stale.obj.chamfer'));
  jobs = mkdtempSync(join(tmpdir(), 'chamfer-jobs-'));
  server = await startServer(paths.chamferd, root.root, 0, ['--jobs', jobs]);
  [doc, info, scene] = await Promise.all(
    ['openapi.json', 'info', 'scenes/solids%2Fcube'].map(async (path) => (await send(`/v1/${path}`)).json),
  );
  ajv = new Ajv2020({ strict: false, allErrors: true });
  ajv.addSchema({ $id: 'doc:', ...doc });
  EXAMPLE.job = await submitted('finished');
  for (let state = ''; state !== 'done'; await sleep(50))
    state = (await send(`/v1/comparisons/${EXAMPLE.job}`)).json.state;
});

after(async () => {
  await server?.stop();
  root?.remove();
  if (jobs) rmSync(jobs, { recursive: true, force: true });
});

/** One request: {status, headers, body, json}; json is null where there is none. */
async function send(path, { url = server.url, ...options } = {}) {
  const answer = await ask(url + path, options);
  const isJson = /json/.test(answer.headers['content-type']) && answer.body.length > 0;
  return { ...answer, json: isJson ? JSON.parse(answer.body) : null };
}

function assertMatches(json, schema) {
  const pointer = `doc:#/components/schemas/${schema}`;
  assert.ok(ajv.validate(pointer, json), `${schema}: ${ajv.errorsText()}`);
}

/** Checks an answer against its operation: the status is documented, headers, type and body are as they should be. */
function assertDocumented(answer, operation, method, what) {
  const response = operation.responses[answer.status];
  assert.ok(response, `${what}: ${answer.status} is not documented: ${answer.body.subarray(0, 300)}`);
  for (const name of Object.keys(response.headers ?? {})) {
    // What a render finds out is not known to HEAD.
    const known = method !== 'HEAD' || !/^(X-Chamfer|Server-Timing)/.test(name);
    if (known) assert.ok(answer.headers[name.toLowerCase()] !== undefined, `${what}: no ${name}`);
  }
  if (method === 'HEAD' || !response.content) return assert.equal(answer.body.length, 0, what);
  const type = answer.headers['content-type'].split(';')[0];
  assert.ok(response.content[type], `${what}: ${type}`);
  const reference = response.content[type].schema?.$ref;
  if (reference) assertMatches(answer.json, reference.split('/').at(-1));
}

const EXAMPLE = { width: 64, height: 48, x: 0, y: 0, w: 1, h: 1, s0: 0, s1: 1, format: 'png', file: '' };
const RAYS = { rays: [[3, -3, 0.1, -1, 1, 0]] };
const CASE = { a: 'solids/cube', b: 'solids/cube?rounding=none', width: 16, height: 16, samples: 1, seeds: 1 };
const suiteOf = (...cases) => ({ schema: 'chamfer.cases/1', cases: cases.map((one, i) => ({ name: `${i}`, ...one })) });

/** The path of a template; `values` go before the examples. */
const fill = (template, values = {}) =>
  template.replaceAll(/\{(\w+)\}/g, (_, name) => ({ scene: scene.id, ...EXAMPLE, ...values })[name]);

const jsonBody = (body) => ({
  method: 'POST',
  headers: { 'Content-Type': 'application/json' },
  body: typeof body === 'string' ? body : JSON.stringify(body),
});

/** What is posted to a path. */
const bodyFor = (template) => jsonBody(template === '/v1/comparisons' ? suiteOf({ ...CASE, name: 'finished' }) : RAYS);

/** Resolves to the id of a new comparison. */
async function submitted(name) {
  const { status, json } = await send('/v1/comparisons', jsonBody(suiteOf({ ...CASE, name })));
  assert.equal(status, 202);
  return json.id;
}

async function assertProblem(answer, status, parameter, what) {
  assert.equal(answer.status, status, `${what}: ${answer.body}`);
  if (!answer.json) return; // HEAD
  assertMatches(answer.json, 'Problem');
  assert.equal(answer.json.status, status, what);
  if (parameter) assert.equal(answer.json.parameter, parameter, what);
}

test('the document is valid OpenAPI 3.1 and its schemas compile', async () => {
  assert.equal(doc.openapi, '3.1.0');
  assert.equal(doc.info.version, info.version);
  const { valid, errors } = await new Validator().validate(structuredClone(doc));
  assert.ok(valid, JSON.stringify(errors, null, 1));
  for (const name of Object.keys(doc.components.schemas)) assert.ok(ajv.getSchema(`doc:#/components/schemas/${name}`));
});

test('every registered route is in the document', async () => {
  const text = (await send('/metrics')).body.toString();
  const routes = new Set([...text.matchAll(/chamfer_requests_total\{route="([^"]+)"/g)].map((match) => match[1]));
  routes.delete('none');
  assert.deepEqual([...routes].sort(), Object.keys(doc.paths).sort());
});

test('every operation answers as documented, every other method is refused', async () => {
  for (const [template, operations] of Object.entries(doc.paths)) {
    for (const method of ['GET', 'HEAD', 'OPTIONS', 'POST', 'PUT', 'DELETE', 'PATCH']) {
      const operation = operations[method.toLowerCase()];
      const what = `${method} ${template}`;
      const gone = method === 'DELETE' && operation ? { job: await submitted('to go') } : {};
      const answer = await send(fill(template, gone), method === 'POST' ? bodyFor(template) : { method });
      if (!operation) {
        await assertProblem(answer, 405, '', what);
        continue;
      }
      assert.equal(answer.status, ['OPTIONS', 'DELETE'].includes(method) ? 204 : 200, what);
      assertDocumented(answer, operation, method, what);
      if (answer.headers.etag && method === 'GET') {
        const again = await send(fill(template), { headers: { 'If-None-Match': answer.headers.etag } });
        const changing = again.status === 200 && ['/v1/info', '/v1/comparisons'].includes(template); // figures move
        if (!changing) assert.equal(again.status, 304, what);
        assertDocumented(again, operation, method, what);
      }
    }
  }
});

test('scenes that are not there, not ready, or called by name answer as documented', async () => {
  for (const [template, operations] of Object.entries(doc.paths)) {
    if (!template.includes('{scene}')) continue;
    const [method] = Object.keys(operations);
    const options = method === 'post' ? jsonBody(RAYS) : {};
    for (const [name, status] of [['none', 404], ['stale', 409], ['solids%2Fcube', 'name']]) {
      const answer = await send(fill(template, { scene: name }), options);
      const redirects = operations[method].responses[307] !== undefined;
      assert.equal(answer.status, status === 'name' ? (redirects ? 307 : 200) : status, template);
      assertDocumented(answer, operations[method], method, `${template} of ${name}`);
    }
  }
});

test('keys and hosts answer as documented', async () => {
  const file = join(root.root, 'keys.txt');
  writeFileSync(file, KEY);
  const guarded = await startServer(paths.chamferd, root.root, 0, ['--key-file', file]);
  try {
    const own = (headers = {}) => send('/v1/openapi.json', { headers, url: guarded.url });
    const { json: guardedDoc } = await own({ Authorization: `Bearer ${KEY}` });
    for (const [template, operations] of Object.entries(doc.paths)) {
      const [method] = Object.keys(operations);
      const askWith = (headers) =>
        send(fill(template), { method: method.toUpperCase(), headers, url: guarded.url });
      const needsKey = guardedDoc.paths[template][method].security !== undefined;
      assert.equal(needsKey, operations[method].responses[401] !== undefined, template);
      for (const [headers, status] of [[{}, 401], [{ 'X-Api-Key': 'wrong' }, 403]]) {
        const answer = await askWith(headers);
        assertDocumented(answer, operations[method], method, template);
        assert.equal(answer.status === status, needsKey, template);
      }
      const known = await askWith({ 'X-Api-Key': KEY });
      assert.ok(![401, 403].includes(known.status), template);
      const foreign = await askWith({ Host: 'evil.example', 'X-Api-Key': KEY });
      assert.equal(foreign.status === 421, operations[method].responses[421] !== undefined, template);
    }
  } finally {
    await guarded.stop();
  }
});

test('every parameter works up to its limits and is refused beyond them', async () => {
  let probed = 0;
  const largest = (parameter) => info.parameters.find((row) => row.name === parameter).limits.maximum;
  for (const [template, operations] of Object.entries(doc.paths)) {
    for (const parameter of operations.get?.parameters ?? []) {
      const { name } = parameter;
      const probes = probesOf(parameter, scene.radius.max);
      if (!probes) continue;
      const { inside, outside } = probes;
      const pathWith = (value) => {
        const path = fill(template, { ...around(name, value, largest), [name]: value });
        return parameter.in === 'path' ? path : `${path}?${name}=${encodeURIComponent(value)}`;
      };
      for (const value of inside) {
        const answer = await send(pathWith(value));
        assert.equal(answer.status, 200, `${pathWith(value)}: ${answer.body.subarray(0, 300)}`);
        assertDocumented(answer, operations.get, 'GET', pathWith(value));
      }
      for (const [value, status, blamed = name] of outside) {
        const answer = await send(pathWith(value));
        // What breaks the form of the path is blamed on the first parameter of that part.
        const formless = ['', '+1', -1].includes(value);
        await assertProblem(answer, status, formless ? '' : blamed, pathWith(value));
        probed++;
      }
      if (parameter.in === 'query') {
        await assertProblem(await send(`${pathWith(inside[0])}&${name}=${inside[0]}`), 400, name, 'given twice');
      }
    }
    if (operations.get?.parameters.some(({ in: place }) => place === 'query')) {
      await assertProblem(await send(`${fill(template)}?frobnicate=1`), 400, 'frobnicate', 'unknown');
    } else if (template.startsWith('/v1') && operations.get) {
      await assertProblem(await send(`${fill(template)}?seed=1`), 400, 'query', template);
    }
  }
  assert.ok(probed > 100, `${probed} probes`);
});

test('the body of a batch of rays is read as documented', async () => {
  const [template, { post }] = Object.entries(doc.paths).find(([, operations]) => operations.post);
  const { schema } = post.requestBody.content['application/json'];
  const [ray] = RAYS.rays;
  const rayWith = (at, value) => ray.map((number, i) => (i === at ? value : number));
  const { maxItems } = schema.properties.rays;
  const { minItems, prefixItems } = schema.properties.rays.items;
  assert.deepEqual(schema.required, ['rays']);
  const good = [
    RAYS,
    { rays: [] },
    { rays: Array(maxItems).fill(ray) },
    { ...RAYS, rounding: 'none', tnear: schema.properties.tnear.maximum },
    { ...RAYS, radius: scene.radius.max * 0.999 },
    { rays: [rayWith(0, prefixItems[0].maximum), rayWith(1, prefixItems[1].minimum)] },
  ];
  const bad = [
    [{}, 400],
    [{ rays: [ray.slice(0, minItems - 1)] }, 400],
    [{ rays: [[...ray, 1]] }, 400],
    [{ rays: Array(maxItems + 1).fill(ray) }, 422],
    [{ rays: [rayWith(2, prefixItems[2].maximum * 1.001)] }, 422],
    [{ ...RAYS, tnear: -1 }, 422],
    [{ ...RAYS, radius: 0 }, 422],
    [{ ...RAYS, radius: scene.radius.max }, 422],
    [{ ...RAYS, rounding: 'frob' }, 400],
    [{ ...RAYS, frobnicate: 1 }, 400],
    ['{', 400],
  ];
  const valid = ajv.compile(schema);
  for (const body of good) {
    const answer = await send(fill(template), jsonBody(body));
    assert.equal(answer.status, 200, `${answer.body.subarray(0, 300)}`);
    assert.ok(valid(body));
    assertMatches(answer.json, 'Hits');
    assert.equal(answer.json.hits.length, body.rays.length);
  }
  for (const [body, status] of bad) {
    const answer = await send(fill(template), jsonBody(body));
    await assertProblem(answer, status, '', JSON.stringify(body).slice(0, 80));
    const documented = typeof body === 'object' && body.radius !== scene.radius.max; // that limit is the scene's
    if (documented) assert.ok(!valid(body), JSON.stringify(body).slice(0, 80));
  }
  const untyped = await send(fill(template), { method: 'POST', body: '{}' });
  await assertProblem(untyped, 415, '', 'no content type');
});

test('suites are read as documented', async () => {
  const rect = [0, 0, 8, 8];
  const good = [
    CASE,
    { ...CASE, crop: rect, only: [rect], except: [[9, 9, 1, 1]] },
    { ...CASE, limits: { mae: 1, flip: 0.5 }, tolerance: { absolute: 0.1, relative: 0 }, seconds: 1 },
    { ...CASE, seeds: 16, statistics: { significance: 0.02, tolerance: { pixel: 1 }, resolution: { image: 1 } } },
    { ...CASE, seeds: 16, statistics: true },
  ];
  const bad = [
    { ...CASE, frobnicate: 1 },
    { ...CASE, a: undefined },
    { ...CASE, width: 0 },
    { ...CASE, height: 65537 },
    { ...CASE, samples: 1.5 },
    { ...CASE, seeds: 4097 },
    { ...CASE, crop: [0, 0, 8] },
    { ...CASE, limits: { mae: -1 } },
    { ...CASE, tolerance: { pixel: 1 } },
    { ...CASE, seeds: 16, statistics: { significance: 0.6 } },
    { ...CASE, seeds: 16, statistics: { resolution: { voxel: 1 } } },
  ];
  const valid = (body) => ajv.validate('doc:#/components/schemas/Suite', JSON.parse(JSON.stringify(body)));
  const post = (body) => send('/v1/comparisons', jsonBody(body));
  for (const one of good) {
    const answer = await post(suiteOf(one));
    assert.ok([200, 202].includes(answer.status), `${answer.body}`);
    assertDocumented(answer, doc.paths['/v1/comparisons'].post, 'POST', 'a suite');
    assert.ok(valid(suiteOf(one)), `${JSON.stringify(one)}: ${ajv.errorsText()}`);
  }
  for (const body of [...bad.map((one) => suiteOf(one)), suiteOf(), { ...suiteOf(CASE), schema: 'chamfer.cases/2' }]) {
    await assertProblem(await post(body), 400, '', JSON.stringify(body));
    assert.ok(!valid(body), JSON.stringify(body));
  }
});

test('the limits of /v1/info are those of the document and of the server', async () => {
  const { limits } = info;
  const documented = doc.components.schemas.Info.properties.limits.properties;
  assert.deepEqual(Object.keys(documented).sort(), Object.keys(limits).sort());
  const tile = Object.keys(doc.paths).find((template) => template.includes('/tiles/'));
  const frame = Object.keys(doc.paths).find((template) => template.includes('/frames/'));
  const rays = fill(Object.keys(doc.paths).find((template) => template.endsWith('/rays')));
  const sized = (width, height) => ({ width, height, w: width, h: height });
  // Beyond what is worth rendering here HEAD, which checks everything and renders nothing.
  const head = (template, values) => send(fill(template, values), { method: 'HEAD' });
  const paddedTo = (bytes) => JSON.stringify({ rays: [] }).padEnd(bytes);
  const fields = (count) => Object.fromEntries(Array.from({ length: count }, (_, i) => [`X-${i}`, 'a']));
  const framing = 2; // Host and Connection, which the client adds
  const { tile_pixels, frame_pixels, request_samples } = limits;
  // Each: a request of so many, that many, one more (or the next that can be asked for), the status of the latter.
  const probes = {
    tile_pixels: [(rows) => head(tile, sized(tile_pixels / 64, rows)), 64, 65, 422],
    frame_pixels: [(rows) => head(frame, sized(frame_pixels / 4096, rows)), 4096, 4097, 422],
    request_samples: [(s1) => head(tile, { ...sized(256, 256), s1 }), request_samples / 65536, request_samples / 65536 + 1, 422],
    rays: [(count) => send(rays, jsonBody({ rays: Array(count).fill(RAYS.rays[0]) })), limits.rays, limits.rays + 1, 422],
    body_bytes: [(bytes) => send(rays, jsonBody(paddedTo(bytes))), limits.body_bytes, limits.body_bytes + 1, 413],
    target_bytes: [(bytes) => send('/livez?'.padEnd(bytes, 'a')), limits.target_bytes, limits.target_bytes + 1, 414],
    header_fields: [
      (count) => send('/livez', { headers: fields(count - framing) }),
      limits.header_fields,
      limits.header_fields + 1,
      431,
    ],
    head_bytes: [
      (bytes) => send('/livez', { headers: { 'X-Long': 'a'.repeat(bytes) } }),
      limits.head_bytes - 200,
      limits.head_bytes,
      431,
    ],
  };
  // Tested where it takes no large scene, or a server of its own: server_test, image_route_test, preview_test,
  // hardening_test, comparisons_test.
  const elsewhere = ['deadline_seconds', 'connections', 'preview_bytes', 'explicit_triangles', 'suite_bytes', 'cases'];
  elsewhere.push('comparison_pixels', 'comparison_samples', 'comparison_file_bytes');
  assert.deepEqual([...Object.keys(probes), ...elsewhere].sort(), Object.keys(limits).sort());
  for (const [name, [request, inside, outside, status]] of Object.entries(probes)) {
    assert.equal((await request(inside)).status, 200, name);
    const answer = await request(outside).catch((error) => error);
    // A client that is still sending may see the connection end before the answer.
    if (answer instanceof Error) assert.match(`${answer.code}`, /ECONNRESET|EPIPE/, name);
    else await assertProblem(answer, status, '', name);
  }
});

test("every scene's preview is valid glTF", async () => {
  const { json: scenes } = await send('/v1/scenes');
  const ready = scenes.filter(({ state }) => state === 'ready');
  assert.ok(ready.length > 5);
  for (const { id, name, triangles } of ready) {
    const { status, body } = await send(`/v1/scenes/${id}/preview.glb`);
    assert.equal(status, 200, name);
    const { issues, info: facts } = await gltf.validateBytes(new Uint8Array(body), { maxIssues: 5 });
    assert.equal(issues.numErrors + issues.numWarnings, 0, `${name}: ${JSON.stringify(issues.messages)}`);
    assert.ok(facts.totalTriangleCount <= triangles, name); // instances share their meshes
  }
});
