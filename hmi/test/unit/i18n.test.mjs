import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../load.mjs';

const { en } = await load('i18n/en.ts');
const { de } = await load('i18n/de.ts');
const { chooseLanguage } = await load('i18n/index.ts');

test('both tables have the same texts with the same places for values', () => {
  assert.deepEqual(Object.keys(de), Object.keys(en));
  const places = (s) => (s.match(/\{\w+\}/g) ?? []).sort();
  for (const key of Object.keys(en)) {
    assert.deepEqual(places(de[key]), places(en[key]), key);
    assert.ok(en[key].trim() && de[key].trim(), key);
  }
});

test('the language: asked for, else the browser’s, else English', () => {
  assert.equal(chooseLanguage('?lang=de', ['en-GB']), 'de');
  assert.equal(chooseLanguage('?lang=en', ['de-DE']), 'en');
  assert.equal(chooseLanguage('', ['de-AT']), 'de');
  assert.equal(chooseLanguage('', ['fr']), 'en');
  assert.equal(chooseLanguage('', []), 'en');
});
