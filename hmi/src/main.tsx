import './style/tokens.css';
import './style/base.css';
import './style/run.css';
import { render } from 'preact';
import { chooseLanguage, setLanguage } from './i18n/index.ts';
import { Run } from './pages/Run.tsx';
import { connect } from './store.ts';

const language = chooseLanguage(location.search, navigator.languages);
setLanguage(language);
document.documentElement.lang = language;
render(<Run />, document.getElementById('app')!);
connect();
