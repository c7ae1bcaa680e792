// node open-report.cjs REPORT.html [--shots FOLDER] [--measure X,Y,Z X,Y,Z] [--size WIDTHxHEIGHT] [--dark]
// Opens a report in headless Chromium without network, clicks through it, and prints what it saw as JSON. Points are in
// the model's frame. Exit code 1 when the page cannot be used at all.
const fs = require('fs');
const os = require('os');
const path = require('path');
const { chromium } = require('playwright-core');

const BROWSER = process.env.QUOIN_CHROMIUM || '/usr/bin/chromium';
const PATIENCE = 240000; // [ms] a loaded machine draws slowly without a graphics card
const FLAGS = ['--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'];

function parse(args) {
    const options = { file: path.resolve(args[0]), size: { width: 1366, height: 768 }, measure: [] };
    for (let i = 1; i < args.length; ++i) {
        if (args[i] === '--shots') options.shots = args[++i];
        else if (args[i] === '--dark') options.dark = true;
        else if (args[i] === '--size') { const [width, height] = args[++i].split('x').map(Number); options.size = { width, height }; }
        else if (args[i] === '--measure') options.measure = [args[++i], args[++i]].map((p) => p.split(',').map(Number));
        else throw new Error(`unknown argument ${args[i]}`);
    }
    return options;
}

// The part of the canvas that is not background, and a sum that changes with what is drawn.
const look = (page) => page.evaluate(() => {
    const { viewer } = window.quoin, gl = viewer.gl;
    viewer.draw();
    const { width, height } = gl.canvas, pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const background = viewer.scene.background.map((c) => Math.round(255 * c));
    let drawn = 0, sum = 0;
    for (let i = 0; i < pixels.length; i += 4) {
        const difference = Math.abs(pixels[i] - background[0]) + Math.abs(pixels[i + 1] - background[1]) + Math.abs(pixels[i + 2] - background[2]);
        if (difference > 12) ++drawn;
        sum = (sum * 31 + pixels[i] + 2 * pixels[i + 1] + 3 * pixels[i + 2]) % 1000003;
    }
    return { drawn: drawn / (width * height), sum, error: gl.getError() };
});

async function choose(page, name, value) {
    await page.locator(`.toolbar input[name=${name}]${value ? `[value=${value}]` : ''} + span`).click();
}

// What every control draws.
async function try_controls(page, shot) {
    const seen = {};
    for (const [name, value] of [['paint', 'planes'], ['paint', 'source'], ['paint', 'plain'], ['paint', 'texture'], ['wire', ''], ['lines', ''], ['cameras', ''], ['walls', ''], ['side', 'dense'], ['side', 'split']]) {
        if (await page.locator(`.toolbar input[name=${name}]${value ? `[value=${value}]` : ''}`).isDisabled()) continue;
        await choose(page, name, value);
        seen[value || name] = await look(page);
        await shot(value || name);
        if (!value) await choose(page, name, value);
    }
    if (!(await page.locator('input[value=split]').isDisabled())) await choose(page, 'side', 'model');
    return seen;
}

async function measure(page, points, shot) {
    for (const point of points) {
        const place = await page.evaluate((p) => { window.quoin.viewer.draw(); return window.quoin.viewer.project(p); }, point);
        const box = await page.locator('#canvas').boundingBox();
        await page.mouse.click(box.x + place[0], box.y + place[1]);
    }
    await shot('measured');
    return { text: await page.locator('#readout').textContent(), label: await page.locator('#overlay text').textContent() };
}

async function main() {
    const options = parse(process.argv.slice(2));
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'quoin-browser-'));
    const browser = await chromium.launchPersistentContext(folder, {
        executablePath: BROWSER, headless: true, args: FLAGS, offline: true, timeout: PATIENCE, viewport: options.size, colorScheme: options.dark ? 'dark' : 'light',
    });
    const result = { errors: [], requests: [] };
    try {
        browser.setDefaultTimeout(PATIENCE);
        const page = await browser.newPage();
        page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/GPU stall/.test(message.text())) result.errors.push(message.text()); });
        page.on('pageerror', (error) => result.errors.push(String(error)));
        page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) result.requests.push(request.url()); });
        const shot = async (name) => { if (options.shots) await page.screenshot({ path: path.join(options.shots, `${name}.png`) }); };
        await page.goto(`file://${options.file}`);
        await page.waitForFunction(() => window.quoin || /cannot be shown/.test(document.getElementById('readout').textContent));
        result.readout = await page.locator('#readout').textContent();
        result.first = await look(page);
        await shot('first');
        if (options.measure.length) result.measured = await measure(page, options.measure, shot);
        await page.locator('#clear').click();
        result.controls = await try_controls(page, shot);
        if (await page.locator('#inside').isEnabled()) {
            await page.locator('#inside').click();
            result.inside = await look(page);
            await shot('inside');
        }
        result.overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        result.sections = await page.evaluate(() => [...document.querySelectorAll('main > section')].filter((s) => !s.hidden).map((s) => s.id || 'view'));
        if (options.shots) await page.screenshot({ path: path.join(options.shots, 'whole.png'), fullPage: true });
    } finally {
        await browser.close();
        fs.rmSync(folder, { recursive: true, force: true });
    }
    console.log(JSON.stringify(result));
}

main().catch((error) => { console.error(String(error)); process.exit(1); });
