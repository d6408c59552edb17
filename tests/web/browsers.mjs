// The browsers of Debian, without a display.
import puppeteer from 'puppeteer-core';

const kSettings = {
  // Pictures are drawn by the processor.
  chromium: {executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage']},
  firefox: {executablePath: '/usr/bin/firefox-esr', browser: 'firefox'},
};

export const launch = (name) => puppeteer.launch({...kSettings[name], headless: true, protocolTimeout: 600000});
