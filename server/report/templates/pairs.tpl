{{%AUTOESCAPE context="HTML"}}
<ul class="links">{{#PAIR}}<li>{{#LINK}}<a href="#{{ANCHOR}}">{{FROM}} &rarr; {{TO}}</a>{{/LINK}}{{#PLAIN}}{{FROM}} &rarr; {{TO}}{{/PLAIN}}</li>{{/PAIR}}{{#MORE}}<li>{{COUNT}} more are in <a href="edges.csv">edges.csv</a></li>{{/MORE}}</ul>
